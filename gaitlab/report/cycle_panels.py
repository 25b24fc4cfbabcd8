"""Parts that all figures over the gait cycle share: a panel with its scale, curves of both sides, events, legend."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..clinical.cycle_average import N_SAMPLES
from ..clinical.document import SIDES
from .colours import DASH, SIDE
from .result import Curve
from .svg import Axes, area, clipped, curve, element, frame, number, straight, text, ticks

TICK_DASH = {"left": "none", "right": "2 1"}
CurveSets = Mapping[str, Mapping[str, Curve]]
"""Curve name to side to its average cycle."""
CycleSets = Mapping[str, Mapping[str, Sequence[np.ndarray]]]
"""Curve name to side to every cycle, shape (101,) each, in the unit of the curve."""
EVERY_CYCLE = "thin line: one cycle; thick line: mean of the cycles"
PERCENT = np.linspace(0.0, 100.0, N_SAMPLES)


@dataclass(frozen=True, kw_only=True)
class CyclePanel:
    """Place, scale and directions of one curve."""

    name: str
    title: str
    axes: Axes
    """The rectangle of the panel; its vertical range is the scale."""
    direction: str
    """Meaning of negative and positive values, and the unit."""
    x_label: bool = False
    """Whether the horizontal axis is named."""
    decimals: int = 0
    """Of values told in words."""

    @property
    def scale(self) -> tuple[float, float]:
        """Lowest and highest value shown, in the unit of the curve."""
        return self.axes.y_range


@dataclass(frozen=True, kw_only=True)
class Marks:
    """Moments of one side's cycle [%]; None where unknown."""

    foot_off: float | None = None
    opposite_foot_off: float | None = None
    opposite_foot_strike: float | None = None


def averages(axes: Axes, curves: Mapping[str, Curve]) -> str:
    """Means of both sides with bands of one standard deviation where there are two cycles or more."""
    return "".join(_average(axes, side, curves[side]) for side in SIDES if side in curves)


def _average(axes: Axes, side: str, values: Curve) -> str:
    band = ""
    if values.sd is not None:
        known = np.isfinite(values.mean) & np.isfinite(values.sd)
        lower, upper = (values.mean - values.sd)[known], (values.mean + values.sd)[known]
        band = area(axes, PERCENT[known], lower, upper, fill=SIDE[side], opacity="0.15")
    return band + cycle_line(axes, side, values.mean, 2.2)


def cycle_line(axes: Axes, side: str, values: np.ndarray, width: float, opacity: float = 1.0) -> str:
    """One curve of shape (101,), unit of the axes, in the side's colour and line style."""
    style = {"stroke": SIDE[side], "stroke_width": width, "stroke_dasharray": DASH[side], "stroke_linejoin": "round"}
    style |= {} if opacity == 1.0 else {"stroke_opacity": opacity}
    return curve(axes, PERCENT, values, **style)


def cycle_lines(axes: Axes, cycles: Mapping[str, Sequence[np.ndarray]], means: Mapping[str, Curve]) -> str:
    """Every cycle of each side as a thin line, shape (101,) each, unit of the axes, and the means above them."""
    thin = "".join(cycle_line(axes, side, values, 0.8, 0.7) for side in SIDES for values in cycles.get(side, ()))
    mean = "".join(cycle_line(axes, side, means[side].mean, 2.4) for side in SIDES if side in means)
    return thin + mean


def mean_range(curves: Mapping[str, Curve]) -> tuple[float, float] | None:
    """Lowest and highest mean of both sides; None without any."""
    return value_range([curves[side].mean for side in SIDES if side in curves])


def value_range(values: Sequence[np.ndarray]) -> tuple[float, float] | None:
    """Lowest and highest finite value of arrays of shape (101,), in their unit; None without any."""
    finite = np.concatenate([v[np.isfinite(v)] for v in values]) if values else np.zeros(0)
    return (float(finite.min()), float(finite.max())) if finite.size else None


def every_range(cycles: Mapping[str, Sequence[np.ndarray]]) -> tuple[float, float] | None:
    """Lowest and highest value of all cycles of both sides, shape (101,) each, in their unit; None without any."""
    return value_range([values for side in SIDES for values in cycles.get(side, ())])


def cycle_panel(panel: CyclePanel, content: str, extent: tuple[float, float] | None, marks: Mapping[str, Marks]) -> str:
    """Draw one panel: frame, title, directions, events of both sides, and `content` cut off at the scale.

    `extent` holds the lowest and highest value; the panel says so when they leave its scale.
    """
    axes = panel.axes
    low, high = panel.scale
    middle = axes.top + axes.height / 2.0
    x = axes.left - 42.0
    turned = {"class": "direction", "text_anchor": "middle"}
    parts = [
        frame(axes, (0.0, 20.0, 40.0, 60.0, 80.0, 100.0), ticks(low, high, 5)),
        text(panel.title, axes.left, axes.top - 8.0, **{"class": "title"}),
        text(panel.direction, x, middle, transform=f"rotate(-90 {number(x)} {number(middle)})", **turned),
        "".join(_draw_marks(axes, side, marks[side]) for side in SIDES if side in marks),
        clipped(axes, content) if content else text("no data", axes.left + 10, axes.top + 18, **{"class": "note"}),
    ]
    if panel.x_label:
        parts.append(text("% of cycle", axes.right, axes.bottom + 29.0, **{"class": "note", "text_anchor": "end"}))
    parts.append(leaves_scale(axes, extent, panel.decimals))
    return element("g", "".join(parts), data_curve=panel.name)


def leaves_scale(axes: Axes, extent: tuple[float, float] | None, decimals: int) -> str:
    """Say so where the lowest or highest value lies outside the axes; empty otherwise."""
    low, high = axes.y_range
    if extent is None or (extent[0] >= low and extent[1] <= high):
        return ""
    words = f"leaves scale: {extent[0]:.{decimals}f} to {extent[1]:.{decimals}f}"
    return text(words, axes.left + 6.0, axes.top + 15.0, **{"class": "alert"})


def _draw_marks(axes: Axes, side: str, marks: Marks) -> str:
    parts = list[str]()
    if marks.foot_off is not None and 0.0 <= marks.foot_off <= 100.0:
        x = axes.x(marks.foot_off)
        line = {"stroke": SIDE[side], "stroke_width": 1.0, "stroke_dasharray": DASH[side]}
        parts.append(straight((x, axes.top), (x, axes.bottom), **line))
    for percent, at_top in ((marks.opposite_foot_off, False), (marks.opposite_foot_strike, True)):
        if percent is not None and 0.0 <= percent <= 100.0:
            x, y = axes.x(percent), axes.top if at_top else axes.bottom
            inwards = y + (8.0 if at_top else -8.0)
            tick = {"stroke": SIDE[side], "stroke_width": 2.4, "stroke_dasharray": TICK_DASH[side]}
            parts.append(straight((x, y), (x, inwards), **tick))
    return "".join(parts)


def legend_lines(marks: Mapping[str, Marks]) -> tuple[str, ...]:
    """What the curves' cycle and the marks of the events mean."""
    known = any(m != Marks() for m in marks.values())
    return (
        "each side on its own cycle, foot strike to foot strike of that side",
        "vertical line in the side's style: foot off of that side" if known else "foot off: unknown",
        *(("short tick at the top: opposite foot strike; at the bottom: opposite foot off",) if known else ()),
    )


def legend(x: float, y: float, lines: Sequence[str]) -> str:
    """Colours of the sides, and sentences below."""
    parts = list[str]()
    for index, side in enumerate(SIDES):
        line = {"stroke": SIDE[side], "stroke_width": 3.0, "stroke_dasharray": DASH[side]}
        parts.append(straight((x + 90.0 * index, y - 4.0), (x + 28.0 + 90.0 * index, y - 4.0), **line))
        parts.append(text(side.capitalize(), x + 34.0 + 90.0 * index, y, **{"class": "title"}))
    return "".join(parts) + "".join(text(w, x, y + 20.0 + 17.0 * i, **{"class": "note"}) for i, w in enumerate(lines))
