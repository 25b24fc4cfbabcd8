"""Pictures of the weights: bars with deviations, fit beside other weights."""

from collections.abc import Mapping, Sequence

import numpy as np

from .colours import CENTRE, criterion_colour
from .result import Criterion, Weights, mapping, real
from .svg import Axes, clipped, figure, frame, rectangle, straight, text, ticks
from .wording import spoken

_WIDTH, _BAR, _GAP, _LABEL = 1000.0, 20.0, 14.0, 270.0
WORST_FIT = 12.0
"""Upper end of the fixed scale of the fit [deg]."""


def weights_figure(weights: Weights) -> str:
    """Draw a bar per criterion with one standard deviation; hatched where not identifiable, a dot per stride."""
    high = max([1.0, *(c.weight or 0.0 for c in weights.criteria)])
    axes = _bar_axes(len(weights.criteria), high)
    parts = [_scale(axes, ticks(0.0, high, 5), "weight (normalised, all sum to 1)")]
    strides = stride_weights(weights)
    for index, criterion in enumerate(weights.criteria):
        y = _row(axes, index)
        values = [stride[criterion.name] for stride in strides if criterion.name in stride]
        parts.append(_criterion_bar(axes, y, criterion, criterion_colour(index)) + _dots(axes, y, values))
    return figure(_WIDTH, axes.bottom + 44.0, "".join(parts), "Weights of the criteria")


def stride_weights(weights: Weights) -> list[dict[str, float]]:
    """Weights of each stride by criterion."""
    strides = weights.document.get("strides")
    items = strides if isinstance(strides, list) else []
    found = [mapping(mapping(item).get("weights")) for item in items]
    return [{name: value for name, v in stride.items() if (value := real(v)) is not None} for stride in found]


def fit_figure(found: float, others: Mapping[str, float]) -> str:
    """Draw the fit [rad] with the weights found and with other weights, best first, in degrees."""
    bars = sorted([("weights found", found), *others.items()], key=lambda item: item[1])
    axes = _bar_axes(len(bars), WORST_FIT)
    parts = [_scale(axes, ticks(0.0, WORST_FIT, 6), "rms difference, model to measured [deg]; shorter is better")]
    for index, (name, rms) in enumerate(bars):
        y = _row(axes, index)
        mine = name == "weights found"
        fill = criterion_colour(0) if mine else "#b9c0c7"
        parts.append(_name(axes, y, spoken(name), "title" if mine else "label"))
        degrees = float(np.degrees(rms))
        end = axes.x(min(degrees, WORST_FIT))
        parts.append(rectangle(axes.left, y, end - axes.left, _BAR, fill=fill))
        parts.append(_value(end, y, f"{degrees:.2f}" + (" ↑" if degrees > WORST_FIT else "")))
    return figure(_WIDTH, axes.bottom + 44.0, "".join(parts), "Fit with the weights found and with others")


def _bar_axes(n_bars: int, high: float) -> Axes:
    height = n_bars * (_BAR + _GAP) + _GAP
    return Axes(left=_LABEL, top=6.0, width=570.0, height=height, x_range=(0.0, high), y_range=(0.0, 1.0))


def _row(axes: Axes, index: int) -> float:
    return axes.top + _GAP + index * (_BAR + _GAP)


def _scale(axes: Axes, values: Sequence[float], words: str) -> str:
    grid = [straight((axes.x(v), axes.top), (axes.x(v), axes.bottom), **{"class": "grid"}) for v in values]
    words_place = {"class": "note", "text_anchor": "end"}
    return frame(axes, values, ()) + "".join(grid) + text(words, axes.right, axes.bottom + 32.0, **words_place)


def _name(axes: Axes, y: float, words: str, kind: str) -> str:
    shown = words if len(words) <= 38 else words[:37] + "…"
    return text(shown, axes.left - 10, y + 14.5, **{"class": kind, "text_anchor": "end"})


def _criterion_bar(axes: Axes, y: float, criterion: Criterion, colour: str) -> str:
    weight = criterion.weight or 0.0
    end = axes.x(weight)
    name = _name(axes, y, spoken(criterion.name), "label")
    if not criterion.identifiable:
        note = f"{weight:.2f}  not identifiable"
        return name + _hatched(axes.left, y, end - axes.left, colour) + _value(end, y, note)
    bar = rectangle(axes.left, y, end - axes.left, _BAR, fill=colour)
    if criterion.sd is None or criterion.at_bound:
        return name + bar + _value(end, y, f"{weight:.2f}" + (" (lower bound)" if criterion.at_bound else ""))
    high = axes.x_range[1]
    low_end, high_end = (axes.x(min(max(weight + s * criterion.sd, 0.0), high)) for s in (-1.0, 1.0))
    return name + bar + _whisker(low_end, high_end, y) + _value(high_end, y, f"{weight:.2f} ± {criterion.sd:.2f}")


def _value(x: float, y: float, words: str) -> str:
    return text(words, x + 8.0, y + 14.5, **{"class": "label"})


def _whisker(low: float, high: float, y: float) -> str:
    middle = y + _BAR / 2.0
    ends = [straight((x, middle - 5.0), (x, middle + 5.0), stroke="#222", stroke_width=1.4) for x in (low, high)]
    return straight((low, middle), (high, middle), stroke="#222", stroke_width=1.4) + "".join(ends)


def _hatched(x: float, y: float, width: float, colour: str) -> str:
    """Bar of diagonal lines: a weight that must not be read."""
    width = max(width, 6.0)
    box = Axes(left=x, top=y, width=width, height=_BAR, x_range=(0.0, 1.0), y_range=(0.0, 1.0))
    starts = np.arange(x - _BAR, x + width, 7.0)
    line = {"stroke": colour, "stroke_width": 1.6}
    lines = "".join(straight((float(s), y + _BAR), (float(s) + _BAR, y), **line) for s in starts)
    return clipped(box, lines) + rectangle(x, y, width, _BAR, fill="none", stroke=colour, **{"class": "hatched"})


def _dots(axes: Axes, y: float, values: Sequence[float]) -> str:
    high = axes.x_range[1]
    place = [axes.x(min(max(value, 0.0), high)) for value in values] if len(values) > 1 else []
    middle = y + _BAR + 4.0
    return "".join(f'<circle cx="{x:.1f}" cy="{middle:.1f}" r="2.6" fill="{CENTRE}"/>' for x in place)
