"""The kinematics page: nine curves over the gait cycle, columns sagittal, frontal, transverse, rows proximal to distal.

Left is red, right is blue, the reference cohort grey. The vertical scale of each curve is always the same, so that
pages can be compared by eye; a curve that leaves its scale is cut off and the panel says so.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from .cycle_panels import (
    EVERY_CYCLE,
    PERCENT,
    CurveSets,
    CyclePanel,
    CycleSets,
    Marks,
    averages,
    cycle_lines,
    cycle_panel,
    every_range,
    legend,
    legend_lines,
    mean_range,
)
from .result import Curve
from .svg import Axes, area, curve, figure, text

_WIDTH, _COLUMN, _ROW = 1000.0, 325.0, 190.0
_PANEL_WIDTH, _PANEL_HEIGHT = 245.0, 128.0
_HEADINGS = ("Sagittal", "Frontal", "Transverse")


@dataclass(frozen=True, kw_only=True)
class Panel(CyclePanel):
    """Place, scale and directions of one curve [deg]."""

    row: int
    column: int
    positive: str
    negative: str


def _panel(name: str, place: tuple[int, int], scale: tuple[float, float], directions: tuple[str, str]) -> Panel:
    row, column = place
    negative, positive = directions
    corner = {"left": 66.0 + column * _COLUMN, "top": 46.0 + row * _ROW}
    return Panel(
        name=name,
        title=name.replace("_", " ").capitalize(),
        row=row,
        column=column,
        axes=Axes(**corner, width=_PANEL_WIDTH, height=_PANEL_HEIGHT, x_range=(0.0, 100.0), y_range=scale),
        positive=positive,
        negative=negative,
        direction=f"{negative} / {positive} [deg]",
        x_label=row == 3 or (column > 0 and row == 1),
    )


# Signs of design/clinical.md; scales wide enough for most pathological gait, zero always inside.
PANELS = (
    _panel("pelvis_tilt", (0, 0), (-20.0, 40.0), ("Post", "Ant")),
    _panel("pelvis_obliquity", (0, 1), (-30.0, 30.0), ("Down", "Up")),
    _panel("pelvis_rotation", (0, 2), (-40.0, 40.0), ("Ext", "Int")),
    _panel("hip_flexion", (1, 0), (-30.0, 70.0), ("Ext", "Flex")),
    _panel("hip_adduction", (1, 1), (-30.0, 30.0), ("Abd", "Add")),
    _panel("hip_rotation", (1, 2), (-40.0, 40.0), ("Ext", "Int")),
    _panel("knee_flexion", (2, 0), (-20.0, 80.0), ("Ext", "Flex")),
    _panel("ankle_dorsiflexion", (3, 0), (-50.0, 40.0), ("Plant", "Dorsi")),
    _panel("foot_progression", (3, 2), (-50.0, 40.0), ("Ext", "Int")),
)


@dataclass(frozen=True, kw_only=True)
class Norms:
    """Reference cohort."""

    description: str = ""
    """Source, n, age and speed."""
    curves: Mapping[str, Curve] = field(default_factory=dict[str, Curve])


NO_NORMS = Norms()


def average_figure(kinematics: CurveSets, marks: Mapping[str, Marks], norms: Norms = NO_NORMS) -> str:
    """Draw the mean of each side, with a band of one standard deviation where there are two cycles or more."""
    drawn = {p.name: norm_band(p, norms) + averages(p.axes, kinematics.get(p.name, {})) for p in PANELS}
    words = ("mean of the cycles, coloured band: ± 1 standard deviation", *norm_legend(norms))
    return _page(drawn, {p.name: mean_range(kinematics.get(p.name, {})) for p in PANELS}, marks, words)


def norm_band(panel: CyclePanel, norms: Norms) -> str:
    """Grey band of the reference cohort, mean +- 1 standard deviation; empty where there is none."""
    band = norms.curves.get(panel.name)
    if band is None or band.sd is None:
        return ""
    middle = curve(panel.axes, PERCENT, band.mean, stroke="#8a949e", stroke_width=1.0)
    return area(panel.axes, PERCENT, band.mean - band.sd, band.mean + band.sd, fill="#d3d8dd") + middle


def norm_legend(norms: Norms) -> tuple[str, ...]:
    """What the grey band is: source, n, age and speed, or that there is none."""
    if not norms.curves:
        return ("no normative band: no reference cohort applies",)
    first, _, speed = norms.description.partition(", speed")
    return (f"grey: mean ± 1 SD of {first},", f"speed{speed}") if speed else (f"grey: mean ± 1 SD of {first}",)


def consistency_figure(cycles: CycleSets, means: CurveSets, marks: Mapping[str, Marks], norms: Norms = NO_NORMS) -> str:
    """Draw every cycle of each side as a thin line, and the means [deg] above them."""
    drawn, extents = dict[str, str](), dict[str, tuple[float, float] | None]()
    for panel in PANELS:
        sides = cycles.get(panel.name, {})
        drawn[panel.name] = norm_band(panel, norms) + cycle_lines(panel.axes, sides, means.get(panel.name, {}))
        extents[panel.name] = every_range(sides)
    return _page(drawn, extents, marks, (EVERY_CYCLE, *norm_legend(norms)))


def _page(
    drawn: Mapping[str, str],
    extents: Mapping[str, tuple[float, float] | None],
    marks: Mapping[str, Marks],
    words: Sequence[str],
) -> str:
    places = [66.0 + _PANEL_WIDTH / 2.0 + column * _COLUMN for column in range(len(_HEADINGS))]
    headings = [
        text(h, x, 16.0, **{"class": "heading", "text_anchor": "middle"})
        for h, x in zip(_HEADINGS, places, strict=True)
    ]
    panels = [cycle_panel(panel, drawn[panel.name], extents[panel.name], marks) for panel in PANELS]
    content = "".join(headings) + "".join(panels) + _legend(marks, words)
    return figure(_WIDTH, 46.0 + 4 * _ROW - 26.0, content, "Joint angles over the gait cycle")


def _legend(marks: Mapping[str, Marks], extra: Sequence[str]) -> str:
    return legend(66.0 + _COLUMN + 2.0, 46.0 + 2 * _ROW + 18.0, (*extra, *legend_lines(marks), "fixed scales"))
