"""Share of each criterion in the cost over the gait cycle, stacked to 100 %."""

from collections.abc import Mapping, Sequence

import numpy as np

from .colours import SIDE, criterion_colour
from .svg import Axes, area, clipped, curve, element, figure, frame, rectangle, straight, text
from .wording import spoken

_WIDTH, _ROW = 1000.0, 20.0
_LEAST_LABEL = 7.0
"""Height of a band that still holds its number [%]."""


def share_figure(
    percent: np.ndarray, share: np.ndarray, names: Sequence[str], marks: Mapping[str, float] | None = None
) -> str:
    """Stack the share of each criterion at each instant, each band with its number, so that no colour is needed.

    Args:
        percent: Instants [% of the cycle], ascending, shape (n,).
        share: Cost of each criterion, any unit, shape (n, n_criteria); each instant is scaled to 100 %.
        names: One per criterion.
        marks: Events by name [% of the cycle].
    """
    axes = Axes(left=70.0, top=58.0, width=900.0, height=230.0, x_range=(0.0, 100.0), y_range=(0.0, 100.0))
    part = np.clip(np.nan_to_num(share), 0.0, None)
    total = part.sum(axis=1, keepdims=True)
    part = 100.0 * np.divide(part, total, out=np.zeros_like(part), where=total > 0.0)
    upper = np.cumsum(part, axis=1)
    bands = list[str]()
    for k in range(part.shape[1]):
        bands.append(area(axes, percent, upper[:, k] - part[:, k], upper[:, k], fill=criterion_colour(k)))
        bands.append(curve(axes, percent, upper[:, k], stroke="#fff", stroke_width=1.5))
    numbers = [_number(axes, percent, part[:, k], upper[:, k], k) for k in range(part.shape[1])]
    parts = [
        frame(axes, (0.0, 20.0, 40.0, 60.0, 80.0, 100.0), (0.0, 20.0, 40.0, 60.0, 80.0, 100.0)),
        clipped(axes, "".join(bands)),
        "".join(numbers),
        *(_mark(axes, name, at, row % 2) for row, (name, at) in enumerate((marks or {}).items())),
        text("share of the cost at that instant [%]", 70.0, 16.0, **{"class": "title"}),
        text("% of cycle", axes.right, axes.bottom + 30.0, **{"class": "note", "text_anchor": "end"}),
        _key(names, axes.bottom + 52.0),
    ]
    height = axes.bottom + 62.0 + _ROW * -(-len(names) // 3)
    return figure(_WIDTH, height, "".join(parts), "Share of each criterion in the cost over the gait cycle")


def _number(axes: Axes, percent: np.ndarray, part: np.ndarray, upper: np.ndarray, index: int) -> str:
    """Number of the criterion where its band is widest, away from the edges; nothing on a thin band."""
    inside = (percent > 3.0) & (percent < 97.0)
    if not inside.any():
        return ""
    at = int(np.argmax(np.where(inside, part, -1.0)))
    if part[at] < _LEAST_LABEL:
        return ""
    x, y = axes.x(float(percent[at])), axes.y(float(upper[at] - 0.5 * part[at]))
    circle = element("circle", cx=x, cy=y, r=8.5, fill="#fff")
    return circle + text(str(index + 1), x, y + 4.5, **{"class": "title", "text_anchor": "middle"})


def _mark(axes: Axes, name: str, percent: float, row: int) -> str:
    """An event; neighbours stand in different rows, because they lie close together."""
    side = next((side for side in SIDE if name.startswith(side)), "")
    x, top = axes.x(percent), axes.top - 14.0 * row
    line = straight((x, top), (x, axes.bottom), stroke="#222", stroke_width=1.2, stroke_dasharray="5 3")
    return line + text(name, x, top - 5.0, fill=SIDE.get(side, "#222"), **{"class": "tick", "text_anchor": "middle"})


def _key(names: Sequence[str], top: float) -> str:
    parts = list[str]()
    for index, name in enumerate(names):
        x, y = 70.0 + 300.0 * (index % 3), top + _ROW * (index // 3)
        parts.append(rectangle(x, y - 10.5, 14.0, 12.0, fill=criterion_colour(index)))
        parts.append(text(f"{index + 1}  {spoken(name)}", x + 20.0, y, **{"class": "label"}))
    return "".join(parts)
