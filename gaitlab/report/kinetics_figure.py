"""The kinetics page: moments, powers and ground reactions over the gait cycle, columns hip, knee, ankle.

Scales are always the same, so that pages can be compared by eye; a curve that leaves its scale is cut off and told.
EMG envelopes have no common unit: each is drawn in percent of the largest mean of its channel.
"""

from collections.abc import Mapping

from .cycle_panels import CyclePanel, Marks, averages, cycle_panel, legend, legend_lines, mean_range
from .result import Curve
from .svg import Axes, figure

_WIDTH, _COLUMN, _ROW = 1000.0, 325.0, 190.0
_TOP, _PANEL_WIDTH, _PANEL_HEIGHT = 26.0, 245.0, 128.0
_LEGEND = 96.0
_EMG_ROW, _EMG_HEIGHT = 118.0, 66.0
Range = tuple[float, float]


def _panel(name: str, place: tuple[int, int], scale: Range, title: str, direction: str) -> CyclePanel:
    row, column = place
    left, top = 66.0 + column * _COLUMN, _TOP + row * _ROW
    axes = Axes(left=left, top=top, width=_PANEL_WIDTH, height=_PANEL_HEIGHT, x_range=(0.0, 100.0), y_range=scale)
    decimals = 0 if row == 2 else 2
    return CyclePanel(name=name, title=title, axes=axes, direction=direction, x_label=row == 2, decimals=decimals)


PANELS = (
    _panel("hip_extensor_moment", (0, 0), (-2.0, 2.0), "Hip moment, internal", "Flexor / Extensor [N·m/kg]"),
    _panel("knee_extensor_moment", (0, 1), (-1.5, 2.0), "Knee moment, internal", "Flexor / Extensor [N·m/kg]"),
    _panel("ankle_plantarflexor_moment", (0, 2), (-1.0, 2.5), "Ankle moment, internal", "Dorsi / Plantar [N·m/kg]"),
    _panel("hip_power", (1, 0), (-3.0, 4.0), "Hip power", "Absorbed / Generated [W/kg]"),
    _panel("knee_power", (1, 1), (-4.0, 3.0), "Knee power", "Absorbed / Generated [W/kg]"),
    _panel("ankle_power", (1, 2), (-3.0, 6.0), "Ankle power", "Absorbed / Generated [W/kg]"),
    _panel("ground_reaction_vertical", (2, 0), (0.0, 150.0), "Ground reaction, vertical", "Up [% body weight]"),
    _panel("ground_reaction_forward", (2, 1), (-40.0, 40.0), "Ground reaction, fore-aft", "Back / Forward [% BW]"),
    _panel("ground_reaction_medial", (2, 2), (-20.0, 20.0), "Ground reaction, sideways", "Lateral / Medial [% BW]"),
)


def kinetics_figure(kinetics: Mapping[str, Mapping[str, Curve]], marks: Mapping[str, Marks]) -> str:
    """Draw the mean of each side, with a band of one standard deviation where there are two cycles or more."""
    panels = [
        cycle_panel(p, averages(p.axes, kinetics.get(p.name, {})), mean_range(kinetics.get(p.name, {})), marks)
        for p in PANELS
    ]
    lines = ("mean of the cycles with a valid plate contact, band: ± 1 standard deviation", *legend_lines(marks))
    bottom = _TOP + 3 * _ROW
    height = bottom + _LEGEND
    return figure(_WIDTH, height, "".join(panels) + legend(66.0, bottom + 10.0, lines), "Kinetics over the gait cycle")


def emg_figure(envelopes: Mapping[str, Mapping[str, Curve]], marks: Mapping[str, Marks]) -> str:
    """Draw the mean envelope of each channel in percent of its own maximum, three in a row."""
    panels = list[str]()
    for index, (label, curves) in enumerate(envelopes.items()):
        extent = mean_range(curves)
        highest = extent[1] if extent is not None and extent[1] > 0.0 else 1.0
        panel = _emg_panel(label, index, highest)
        own = {side: mark for side, mark in marks.items() if side in curves}
        scaled = {side: _scaled(curve, 100.0 / highest) for side, curve in curves.items()}
        panels.append(cycle_panel(panel, averages(panel.axes, scaled), None, own))
    height = _TOP + _EMG_ROW * ((len(envelopes) + 2) // 3)
    return figure(_WIDTH, height, "".join(panels), "EMG envelopes over the gait cycle")


def _scaled(curve: Curve, factor: float) -> Curve:
    return Curve(mean=factor * curve.mean, sd=None if curve.sd is None else factor * curve.sd, n_cycles=curve.n_cycles)


def _emg_panel(label: str, index: int, highest: float) -> CyclePanel:
    row, column = divmod(index, 3)
    left, top = 66.0 + column * _COLUMN, _TOP + row * _EMG_ROW
    axes = Axes(left=left, top=top, width=_PANEL_WIDTH, height=_EMG_HEIGHT, x_range=(0.0, 100.0), y_range=(0.0, 125.0))
    return CyclePanel(name=label, title=label, axes=axes, direction=f"% of {highest:.2g}")
