"""The kinetics page: moments, powers and ground reactions over the gait cycle, columns hip, knee, ankle.

Scales are always the same, so that pages can be compared by eye; a curve that leaves its scale is cut off and told.
"""

from collections.abc import Mapping
from dataclasses import replace

from .cycle_panels import CyclePanel, Marks, averages, cycle_panel, legend, legend_lines, mean_range
from .kinematics_figure import NO_NORMS, Norms, norm_band, norm_legend
from .result import Curve
from .svg import Axes, figure

_WIDTH, _COLUMN, _ROW = 1000.0, 325.0, 190.0
_TOP, _PANEL_WIDTH, _PANEL_HEIGHT = 26.0, 245.0, 128.0
_LEGEND = 150.0
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


def kinetics_figure(
    kinetics: Mapping[str, Mapping[str, Curve]], marks: Mapping[str, Marks], norms: Norms = NO_NORMS
) -> str:
    """Draw the mean of each side, with a band of one standard deviation where there are two cycles or more.

    `norms` may hold bands of these curves among others; they are drawn grey.
    """
    known = replace(norms, curves={p.name: norms.curves[p.name] for p in PANELS if p.name in norms.curves})
    panels = [_kinetics_panel(p, kinetics.get(p.name, {}), marks, known) for p in PANELS]
    absent = [p.title.lower() for p in PANELS if p.name not in known.curves] if known.curves else []
    lines = (
        "mean of the cycles with a valid plate contact, coloured band: ± 1 standard deviation; fixed scales",
        *norm_legend(known),
        *((f"no norms of: {', '.join(absent)}",) if absent else ()),
        *legend_lines(marks),
    )
    bottom = _TOP + 3 * _ROW
    height = bottom + _LEGEND
    return figure(_WIDTH, height, "".join(panels) + legend(66.0, bottom + 10.0, lines), "Kinetics over the gait cycle")


def _kinetics_panel(panel: CyclePanel, curves: Mapping[str, Curve], marks: Mapping[str, Marks], norms: Norms) -> str:
    return cycle_panel(panel, norm_band(panel, norms) + averages(panel.axes, curves), mean_range(curves), marks)
