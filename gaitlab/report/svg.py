"""Scalable vector graphics as text, written by hand: the same input always gives the same bytes.

Every function returns markup for use inside an `svg` element of an HTML page. Lengths are user units, about a pixel on
screen; y points down. Text stays text, so that a reader can search and copy it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

STYLE: Mapping[str, str] = {
    "text": "font-size:12px;fill:#1c232b",
    ".title": "font-size:14px;font-weight:600",
    ".heading": "font-size:14.5px;font-weight:600;fill:#5b6672",
    ".tick": "font-size:12px;fill:#5b6672",
    ".direction": "font-size:11.5px;fill:#5b6672",
    ".note": "font-size:12.5px;fill:#5b6672",
    ".label": "font-size:13px",
    ".alert": "font-size:11px;font-weight:600;fill:#a85a00;paint-order:stroke;stroke:#fff;stroke-width:3px",
    ".panel": "fill:none;stroke:#9aa4ae;stroke-width:1",
    ".axis": "stroke:#9aa4ae;stroke-width:1",
    ".grid": "stroke:#e3e7eb;stroke-width:1",
    ".zero": "stroke:#8a949e;stroke-width:1",
}
"""Look of the classes that figures use."""
FONTS = "system-ui,'DejaVu Sans',Arial,sans-serif"
_ENTER = "M"
_CONTINUE = "L"
_MOST_POINTS = 150


@dataclass(frozen=True, kw_only=True)
class Axes:
    """A rectangle of the figure in which data are drawn, and the data range that it shows."""

    left: float
    top: float
    width: float
    height: float
    x_range: tuple[float, float]
    y_range: tuple[float, float]

    def x(self, value: float) -> float:
        """Horizontal place of a data value."""
        low, high = self.x_range
        return self.left + self.width * (value - low) / (high - low)

    def y(self, value: float) -> float:
        """Vertical place of a data value."""
        low, high = self.y_range
        return self.top + self.height * (high - value) / (high - low)

    @property
    def bottom(self) -> float:
        """Vertical place of the lower edge."""
        return self.top + self.height

    @property
    def right(self) -> float:
        """Horizontal place of the right edge."""
        return self.left + self.width


def number(value: float) -> str:
    """Write a coordinate with one decimal, without a trailing zero and without a negative zero."""
    written = f"{value:.1f}".removesuffix(".0")
    return "0" if written == "-0" else written


def attributes(values: Mapping[str, object]) -> str:
    """Write XML attributes, escaped; `stroke_width` becomes `stroke-width`."""
    written = [(k.replace("_", "-"), number(v) if isinstance(v, float) else str(v)) for k, v in values.items()]
    return "".join(f' {name}="{escape(text)}"' for name, text in written)


def element(tag: str, markup: str = "", /, **values: object) -> str:
    """Write one element; `markup` is trusted."""
    return f"<{tag}{attributes(values)}>{markup}</{tag}>" if markup else f"<{tag}{attributes(values)}/>"


def text(words: str, x: float, y: float, **values: object) -> str:
    """Write words at a point; they are escaped."""
    return element("text", escape(words), x=float(x), y=float(y), **values)


def straight(start: tuple[float, float], end: tuple[float, float], **values: object) -> str:
    """Draw a straight line."""
    (x1, y1), (x2, y2) = start, end
    return element("line", x1=float(x1), y1=float(y1), x2=float(x2), y2=float(y2), **values)


def rectangle(x: float, y: float, width: float, height: float, **values: object) -> str:
    """Draw a rectangle; a negative width or height counts as none."""
    size = {"width": max(float(width), 0.0), "height": max(float(height), 0.0)}
    return element("rect", x=float(x), y=float(y), **size, **values)


def thinned(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Every k-th of the samples, both of shape (n,), so that about 150 are left; a gap between two stays a gap."""
    step = int(np.ceil(len(y) / _MOST_POINTS))
    if step <= 1:
        return x, y
    starts = np.arange(0, len(y), step)
    whole = np.array([np.isfinite(y[start : start + step]).all() for start in starts])
    return x[starts], np.where(whole, y[starts], np.nan)


def curve(axes: Axes, x: np.ndarray, y: np.ndarray, **values: object) -> str:
    """Draw y over x, both of shape (n,); a value that is not finite interrupts the line."""
    x, y = thinned(x, y)
    step, parts = _ENTER, list[str]()
    for abscissa, ordinate in zip(x.tolist(), y.tolist(), strict=True):
        if not (np.isfinite(abscissa) and np.isfinite(ordinate)):
            step = _ENTER
            continue
        parts.append(f"{step}{number(axes.x(abscissa))} {number(axes.y(ordinate))}")
        step = _CONTINUE
    return element("path", d="".join(parts), fill="none", **values) if parts else ""


def area(axes: Axes, x: np.ndarray, lower: np.ndarray, upper: np.ndarray, **values: object) -> str:
    """Fill the band between two curves, all of shape (n,); values that are not finite count as zero."""
    lower, upper = (np.nan_to_num(v, posinf=0.0, neginf=0.0) for v in (lower, upper))
    x, (_, lower), (_, upper) = thinned(x, lower)[0], thinned(x, lower), thinned(x, upper)
    outline = [*zip(x, upper, strict=True), *zip(x[::-1], lower[::-1], strict=True)]
    points = " ".join(f"{number(axes.x(a))},{number(axes.y(b))}" for a, b in outline)
    return element("polygon", points=points, **values)


def clipped(axes: Axes, content: str) -> str:
    """Show only what lies inside the rectangle of `axes`: a nested `svg` cuts off the rest and needs no identifier."""
    place = {"x": axes.left, "y": axes.top, "width": axes.width, "height": axes.height}
    view = " ".join(number(v) for v in place.values())
    return element("svg", content, **place, viewBox=view, overflow="hidden")


def ticks(low: float, high: float, count: int = 5) -> list[float]:
    """Round values inside [low, high], about `count` of them, steps of 1, 2 or 5 times a power of ten."""
    span = high - low
    if not np.isfinite(span) or span <= 0.0:
        return []
    rough = span / count
    power = 10.0 ** np.floor(np.log10(rough))
    step = min((factor * power for factor in (1.0, 2.0, 5.0, 10.0)), key=lambda s: abs(s - rough))
    first, last = int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9))
    return [k * step for k in range(first, last + 1)]


def frame(axes: Axes, x_ticks: Sequence[float], y_ticks: Sequence[float], x_labels: bool = True) -> str:
    """Draw the box of a panel with grid lines and tick labels; the zero line is darker."""
    parts = [rectangle(axes.left, axes.top, axes.width, axes.height, **{"class": "panel"})]
    for value in y_ticks:
        kind = "zero" if value == 0.0 else "grid"
        parts.append(straight((axes.left, axes.y(value)), (axes.right, axes.y(value)), **{"class": kind}))
        parts.append(text(f"{value:g}", axes.left - 5, axes.y(value) + 3.5, **{"class": "tick", "text_anchor": "end"}))
    for value in x_ticks:
        parts.append(straight((axes.x(value), axes.bottom), (axes.x(value), axes.bottom + 4), **{"class": "axis"}))
        if x_labels:
            place = {"class": "tick", "text_anchor": "middle"}
            parts.append(text(f"{value:g}", axes.x(value), axes.bottom + 15, **place))
    return "".join(parts)


def figure(width: float, height: float, content: str, title: str) -> str:
    """Wrap markup in a figure that scales with the page; the title is read by screen readers."""
    view = f"0 0 {number(width)} {number(height)}"
    name = element("title", escape(title))
    return element("svg", name + content, viewBox=view, role="img", **{"class": "figure", "aria_label": title})


def style_sheet(scope: str = "") -> str:
    """Style rules of the figures, for elements inside `scope`, for instance `.figure `."""
    return "".join(f"{scope}{selector}{{{rules}}}" for selector, rules in STYLE.items())


def standalone(markup: str, fonts: str = FONTS) -> str:
    """The same figure with its style inside, so that it can stand in a file of its own."""
    start, end = markup.split(">", 1)
    style = element("style", f"text{{font-family:{fonts}}}{style_sheet()}")
    return start.replace("<svg", '<svg xmlns="http://www.w3.org/2000/svg"', 1) + ">" + style + end
