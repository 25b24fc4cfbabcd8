"""The kinematics page: nine curves over the gait cycle, columns sagittal, frontal, transverse, rows proximal to distal.

Left is red, right is blue, the reference cohort grey. The vertical scale of each curve is always the same, so that
pages can be compared by eye; a curve that leaves its scale is cut off and the panel says so.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..clinical.cycle_average import N_SAMPLES
from ..clinical.document import SIDES
from .colours import SIDE
from .result import Curve
from .svg import Axes, area, clipped, curve, figure, frame, number, straight, text, ticks

PERCENT = np.linspace(0.0, 100.0, N_SAMPLES)
_WIDTH, _COLUMN, _ROW = 1000.0, 325.0, 190.0
_PANEL_WIDTH, _PANEL_HEIGHT = 245.0, 128.0
_HEADINGS = ("Sagittal", "Frontal", "Transverse")


@dataclass(frozen=True, kw_only=True)
class Panel:
    """Place, scale and directions of one curve."""

    name: str
    title: str
    row: int
    column: int
    scale: tuple[float, float]
    """Lowest and highest value shown [deg]."""
    positive: str
    negative: str

    @property
    def axes(self) -> Axes:
        """The rectangle of the panel."""
        left, top = 66.0 + self.column * _COLUMN, 46.0 + self.row * _ROW
        place = {"left": left, "top": top, "width": _PANEL_WIDTH, "height": _PANEL_HEIGHT}
        return Axes(**place, x_range=(0.0, 100.0), y_range=self.scale)


def _panel(name: str, place: tuple[int, int], scale: tuple[float, float], directions: tuple[str, str]) -> Panel:
    title = name.replace("_", " ").capitalize()
    negative, positive = directions
    row, column = place
    return Panel(name=name, title=title, row=row, column=column, scale=scale, positive=positive, negative=negative)


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
class Marks:
    """Moments of one side's cycle [%]; None where unknown."""

    foot_off: float | None = None
    opposite_foot_off: float | None = None
    opposite_foot_strike: float | None = None


@dataclass(frozen=True, kw_only=True)
class Norms:
    """Reference cohort."""

    description: str = ""
    """Source, n, age and speed."""
    curves: Mapping[str, Curve] = field(default_factory=dict[str, Curve])


NO_NORMS = Norms()


def average_figure(
    kinematics: Mapping[str, Mapping[str, Curve]], marks: Mapping[str, Marks], norms: Norms = NO_NORMS
) -> str:
    """Draw the mean of each side, with a band of one standard deviation where there are two cycles or more."""
    drawn = {
        p.name: norm_band(p, norms) + "".join(_average(p.axes, s, c) for s, c in _sides(kinematics.get(p.name, {})))
        for p in PANELS
    }
    legend = ("mean of the cycles, coloured band: ± 1 standard deviation", *_norm_legend(norms))
    return _page(drawn, {p.name: _extent(kinematics.get(p.name, {})) for p in PANELS}, marks, legend)


def norm_band(panel: Panel, norms: Norms) -> str:
    """Grey band of the reference cohort, mean +- 1 standard deviation; empty where there is none."""
    band = norms.curves.get(panel.name)
    if band is None or band.sd is None:
        return ""
    middle = curve(panel.axes, PERCENT, band.mean, stroke="#8a949e", stroke_width=1.0)
    return area(panel.axes, PERCENT, band.mean - band.sd, band.mean + band.sd, fill="#d3d8dd") + middle


def _norm_legend(norms: Norms) -> tuple[str, ...]:
    if not norms.curves:
        return ("no normative band: no reference cohort applies",)
    first, _, speed = norms.description.partition(", speed")
    return (f"grey: mean ± 1 SD of {first},", f"speed{speed}") if speed else (f"grey: mean ± 1 SD of {first}",)


def consistency_figure(
    cycles: Mapping[str, Mapping[str, Sequence[np.ndarray]]], marks: Mapping[str, Marks], norms: Norms = NO_NORMS
) -> str:
    """Draw every cycle of each side, curve name to side to curves [deg] of shape (101,)."""
    drawn, extents = dict[str, str](), dict[str, tuple[float, float] | None]()
    for panel in PANELS:
        sides = cycles.get(panel.name, {})
        lines = "".join(_line(panel.axes, s, y, 1.2) for s in SIDES for y in sides.get(s, ()))
        drawn[panel.name] = norm_band(panel, norms) + lines
        extents[panel.name] = _range([y for s in SIDES for y in sides.get(s, ())])
    return _page(drawn, extents, marks, ("each line is one cycle", *_norm_legend(norms)))


def _sides(curves: Mapping[str, Curve]) -> list[tuple[str, Curve]]:
    return [(side, curves[side]) for side in SIDES if side in curves]


def _extent(curves: Mapping[str, Curve]) -> tuple[float, float] | None:
    return _range([c.mean for _, c in _sides(curves)])


def _range(values: Sequence[np.ndarray]) -> tuple[float, float] | None:
    finite = np.concatenate([v[np.isfinite(v)] for v in values]) if values else np.zeros(0)
    return (float(finite.min()), float(finite.max())) if finite.size else None


def _average(axes: Axes, side: str, values: Curve) -> str:
    band = ""
    if values.sd is not None:
        known = np.isfinite(values.mean) & np.isfinite(values.sd)
        lower, upper = (values.mean - values.sd)[known], (values.mean + values.sd)[known]
        band = area(axes, PERCENT[known], lower, upper, fill=SIDE[side], opacity="0.15")
    return band + _line(axes, side, values.mean, 2.2)


def _line(axes: Axes, side: str, values: np.ndarray, width: float) -> str:
    return curve(axes, PERCENT, values, stroke=SIDE[side], stroke_width=width, stroke_linejoin="round")


def _page(
    drawn: Mapping[str, str],
    extents: Mapping[str, tuple[float, float] | None],
    marks: Mapping[str, Marks],
    legend: Sequence[str],
) -> str:
    places = [66.0 + _PANEL_WIDTH / 2.0 + column * _COLUMN for column in range(len(_HEADINGS))]
    headings = [
        text(h, x, 16.0, **{"class": "heading", "text_anchor": "middle"})
        for h, x in zip(_HEADINGS, places, strict=True)
    ]
    panels = [_draw_panel(panel, drawn[panel.name], extents[panel.name], marks) for panel in PANELS]
    content = "".join(headings) + "".join(panels) + _legend(marks, legend)
    return figure(_WIDTH, 46.0 + 4 * _ROW - 26.0, content, "Joint angles over the gait cycle")


def _draw_panel(panel: Panel, content: str, extent: tuple[float, float] | None, marks: Mapping[str, Marks]) -> str:
    axes = panel.axes
    low, high = panel.scale
    middle = axes.top + axes.height / 2.0
    x = axes.left - 42.0
    turned = {"class": "direction", "text_anchor": "middle"}
    direction = f"{panel.negative} / {panel.positive} [deg]"
    parts = [
        frame(axes, (0.0, 20.0, 40.0, 60.0, 80.0, 100.0), ticks(low, high, 5)),
        text(panel.title, axes.left, axes.top - 8.0, **{"class": "title"}),
        text(direction, x, middle, transform=f"rotate(-90 {number(x)} {number(middle)})", **turned),
        "".join(_draw_marks(axes, side, marks[side]) for side in SIDES if side in marks),
        clipped(axes, content) if content else text("no data", axes.left + 10, axes.top + 18, **{"class": "note"}),
    ]
    if panel.row == 3 or panel.column > 0 and panel.row == 1:
        parts.append(text("% of cycle", axes.right, axes.bottom + 29.0, **{"class": "note", "text_anchor": "end"}))
    if extent is not None and (extent[0] < low or extent[1] > high):
        words = f"leaves scale: {extent[0]:.0f} to {extent[1]:.0f}"
        parts.append(text(words, axes.left + 6.0, axes.top + 15.0, **{"class": "alert"}))
    return f'<g data-curve="{panel.name}">{"".join(parts)}</g>'


def _draw_marks(axes: Axes, side: str, marks: Marks) -> str:
    parts = list[str]()
    if marks.foot_off is not None and 0.0 <= marks.foot_off <= 100.0:
        x = axes.x(marks.foot_off)
        line = {"stroke": SIDE[side], "stroke_width": 1.2, "stroke_dasharray": "5 3"}
        parts.append(straight((x, axes.top), (x, axes.bottom), **line))
    for percent, at_top in ((marks.opposite_foot_off, False), (marks.opposite_foot_strike, True)):
        if percent is not None and 0.0 <= percent <= 100.0:
            x, y = axes.x(percent), axes.top if at_top else axes.bottom
            inwards = y + (8.0 if at_top else -8.0)
            parts.append(straight((x, y), (x, inwards), stroke=SIDE[side], stroke_width=2.0))
    return "".join(parts)


def _legend(marks: Mapping[str, Marks], extra: Sequence[str]) -> str:
    x, y = 66.0 + _COLUMN + 2.0, 46.0 + 2 * _ROW + 18.0
    parts = list[str]()
    for index, side in enumerate(SIDES):
        line = {"stroke": SIDE[side], "stroke_width": 3.0}
        parts.append(straight((x + 90.0 * index, y - 4.0), (x + 28.0 + 90.0 * index, y - 4.0), **line))
        parts.append(text(side.capitalize(), x + 34.0 + 90.0 * index, y, **{"class": "title"}))
    known = any(m != Marks() for m in marks.values())
    lines = (
        *extra,
        "each side on its own cycle, foot strike to foot strike of that side",
        "dashed vertical line: foot off of that side" if known else "foot off: unknown",
        "short tick at the top: opposite foot strike; at the bottom: opposite foot off" if known else "",
        "fixed scales",
    )
    shown = [line for line in lines if line]
    return "".join(parts) + "".join(text(w, x, y + 20.0 + 17.0 * i, **{"class": "note"}) for i, w in enumerate(shown))
