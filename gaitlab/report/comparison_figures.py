"""Figures of a comparison: each is one SVG file that needs nothing else. Colour is side, line style is session."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..clinical.comparison import Band, Comparison, Member, group_bands, quantities
from ..clinical.document import SIDES
from ..clinical.gait_profile import GPS_MINIMAL_DIFFERENCE, VARIABLES
from .colours import CENTRE, SIDE
from .cycle_panels import CyclePanel, leaves_scale, value_range
from .formatting import label
from .kinematics_figure import NO_NORMS, PANELS, PERCENT, Norms, norm_band
from .kinetics_figure import PANELS as FORCE_PANELS
from .result import Curve
from .svg import (
    Axes,
    area,
    clipped,
    curve,
    element,
    figure,
    frame,
    number,
    rectangle,
    standalone,
    straight,
    text,
    ticks,
)
from .weights_series import WeightSeries, weight_series
from .wording import spoken

DASHES = ("none", "7 4", "2 3", "9 3 2 3", "12 3", "1 4")
"""Line styles of the groups, in their order."""
MOST_LABELS = 12
"""More results than these are not labelled on an axis; the tables name them."""
_WIDTH = 1000.0
SCALES: Mapping[str, tuple[float, float]] = {
    "speed_m_per_s": (0.0, 2.0),
    "cadence_steps_per_min": (0.0, 200.0),
    "stride_length_m": (0.0, 2.0),
    "step_length_m": (0.0, 1.0),
    "step_width_m": (0.0, 0.4),
    "stride_time_s": (0.0, 3.0),
    "step_time_s": (0.0, 2.0),
    "foot_off_percent": (0.0, 100.0),
    "opposite_foot_off_percent": (0.0, 50.0),
    "opposite_foot_strike_percent": (0.0, 100.0),
    "single_support_percent": (0.0, 100.0),
    "double_support_percent": (0.0, 100.0),
}
"""Fixed scales; a value outside is drawn at the edge with an arrow."""
SCORE_SCALES: Mapping[str, tuple[float, float]] = {
    "gps": (0.0, 30.0),
    "gps_overall": (0.0, 30.0),
    "gdi": (0.0, 130.0),
    **{f"gvs_{name}": (0.0, 30.0) for name in VARIABLES},
}
_SCORES = {"gps": "GPS [deg]", "gps_overall": "GPS overall [deg]", "gdi": "GDI"} | {
    f"gvs_{name}": f"GVS {name.replace('_', ' ')} [deg]" for name in VARIABLES
}


@dataclass(frozen=True, kw_only=True)
class _Dot:
    """One value of one result."""

    place: float
    side: str
    value: float
    sd: float | None


def figures(comparison: Comparison) -> dict[str, str]:
    """Every figure by name: curves, scores, spatiotemporal; kinetics and weights only where a result has some."""
    found = {
        "curves": curves_figure(comparison),
        "scores": dots_figure(comparison, SCORE_SCALES, "Scores"),
        "spatiotemporal": dots_figure(comparison, SCALES, "Distances and times"),
    }
    if any(m.document.kinetics is not None and m.document.kinetics.curves for m in comparison.members):
        found["kinetics"] = kinetics_figure(comparison)
    series = weight_series(comparison)
    return {**found, **({"weights": weights_figure(series)} if series else {})}


def curves_figure(comparison: Comparison) -> str:
    """Nine angles: mean of each group with its band (of one result: of its cycles), grey the reference cohort."""
    lines = ("angles in deg, signs as on the axes",)
    return _curves_page(comparison, PANELS, lines, "Joint angles over the gait cycle")


def kinetics_figure(comparison: Comparison) -> str:
    """The same of moments, powers and ground reactions."""
    frames = {m.document.kinetics.moments_in for m in comparison.members if m.document.kinetics is not None}
    words = f"moments: internal, per body mass, in {' / '.join(sorted(frames))}; power: generation positive"
    lines = (words, *(("moments are not comparable: they are in different axes",) if len(frames) > 1 else ()))
    return _curves_page(comparison, FORCE_PANELS, lines, "Kinetics over the gait cycle")


def _curves_page(comparison: Comparison, panels: Sequence[CyclePanel], extra: Sequence[str], title: str) -> str:
    groups = comparison.groups()
    if len(groups) > len(DASHES):
        groups = {f"all {len(comparison.members)} results": comparison.members}
    bands = {name: group_bands(members) for name, members in groups.items()}
    norms = _norms(comparison.members)
    content = "".join(_curve_panel(panel, bands, norms) for panel in panels)
    lines = ["band: ± 1 SD between the results of a group (of one result: between its cycles); fixed scales"]
    lines.append(f"grey: mean ± 1 SD of {norms.description}" if norms.curves else "grey: no common reference cohort")
    bottom = max(panel.axes.bottom for panel in panels) + 56.0
    legend = _legend({name: len(members) for name, members in groups.items()}, bottom)
    notes = enumerate((*lines, *extra))
    words = "".join(text(w, 66.0, bottom + 56.0 + 17.0 * k, **{"class": "note"}) for k, w in notes)
    return _standalone(bottom + 70.0 + 17.0 * (1 + len(extra)), content + legend + words, title)


def _norms(members: Sequence[Member]) -> Norms:
    """The cohort that all results were compared with; none when they differ."""
    references = [m.document.scores.reference for m in members if m.document.scores is not None]
    first = references[0] if references else None
    if first is None or len(references) < len(members):
        return NO_NORMS
    bands = first.curves | first.kinetics
    if any(reference is None or reference.curves | reference.kinetics != bands for reference in references):
        return NO_NORMS
    curves = {
        name: Curve(mean=np.array(band.mean), sd=np.array(band.sd), n_cycles=first.n) for name, band in bands.items()
    }
    return Norms(description=first.description, curves=curves)


def _curve_panel(panel: CyclePanel, bands: Mapping[str, Mapping[tuple[str, str], Band]], norms: Norms) -> str:
    axes = panel.axes
    drawn = [norm_band(panel, norms)]
    for dash, group in zip(DASHES, bands.values(), strict=False):
        drawn += [_band(axes, side, band, dash) for side in SIDES if (band := group.get((panel.name, side)))]
    means = [band.mean for group in bands.values() for side in SIDES if (band := group.get((panel.name, side)))]
    x, middle = axes.left - 42.0, axes.top + axes.height / 2.0
    turned = {"class": "direction", "text_anchor": "middle", "transform": f"rotate(-90 {number(x)} {number(middle)})"}
    return "".join(
        [
            frame(axes, (0.0, 20.0, 40.0, 60.0, 80.0, 100.0), ticks(*panel.scale, 5)),
            text(panel.title, axes.left, axes.top - 8.0, **{"class": "title"}),
            text(panel.direction, x, middle, **turned),
            text("% of cycle", axes.right, axes.bottom + 29.0, **{"class": "note", "text_anchor": "end"}),
            clipped(axes, "".join(drawn)),
            leaves_scale(axes, value_range(means), panel.decimals),
        ]
    )


def _band(axes: Axes, side: str, band: Band, dash: str) -> str:
    spread = ""
    if band.sd is not None:
        lower, upper = band.mean - band.sd, band.mean + band.sd
        spread = area(axes, PERCENT, lower, upper, fill=SIDE[side], opacity="0.12")
    return spread + curve(axes, PERCENT, band.mean, stroke=SIDE[side], stroke_width=1.8, stroke_dasharray=dash)


def _legend(groups: Mapping[str, int], y: float) -> str:
    parts = list[str]()
    for index, (side, colour) in enumerate(SIDE.items()):
        parts.append(rectangle(66.0 + 80.0 * index, y - 10.0, 14.0, 10.0, fill=colour))
        parts.append(text(side, 85.0 + 80.0 * index, y, **{"class": "title"}))
    for index, (dash, (name, n)) in enumerate(zip(DASHES, groups.items(), strict=False)):
        x, row = 66.0 + 300.0 * (index % 3), y + 20.0 + 16.0 * (index // 3)
        line = {"stroke": "#222", "stroke_width": 2.0, "stroke_dasharray": dash}
        parts.append(straight((x, row - 4.0), (x + 44.0, row - 4.0), **line))
        parts.append(text(f"{_short(name, 30)} (n = {n})", x + 50.0, row))
    return "".join(parts)


def dots_figure(comparison: Comparison, scales: Mapping[str, tuple[float, float]], title: str) -> str:
    """A panel per quantity: a dot per result and side with its standard deviation, in the order of the tables."""
    found = [{(q.name, q.side): q for q in quantities(m.document)} for m in comparison.members]
    shown = [name for name in scales if any(key[0] == name for values in found for key in values)]
    if not shown:
        return _standalone(60.0, text(f"{title}: no result holds any", 20.0, 30.0, **{"class": "title"}), title)
    n = len(comparison.members)
    parts = list[str]()
    for index, name in enumerate(shown):
        dots = [
            _Dot(place=place + _OFFSET[key[1]], side=key[1], value=q.value, sd=q.sd)
            for place, values in enumerate(found)
            for key, q in values.items()
            if key[0] == name
        ]
        parts.append(_dot_panel(name, (index % 3, index // 3), (float(n), scales[name]), dots))
    bottom = 40.0 + 190.0 * (-(-len(shown) // 3))
    return _standalone(bottom + 40.0 + 16.0 * min(n, MOST_LABELS), "".join(parts) + _names(comparison, bottom), title)


_OFFSET = {"left": 0.35, "right": 0.65, "": 0.5}


def _dot_panel(name: str, place: tuple[int, int], extent: tuple[float, tuple[float, float]], dots: list[_Dot]) -> str:
    n, scale = extent
    axes = Axes(
        left=66.0 + 325.0 * place[0],
        top=36.0 + 190.0 * place[1],
        width=245.0,
        height=130.0,
        x_range=(0.0, n),
        y_range=scale,
    )
    words = _SCORES.get(name) or label(name)
    parts = [frame(axes, (), ticks(*scale, 5)), text(words, axes.left, axes.top - 8.0, **{"class": "title"})]
    if n <= MOST_LABELS:
        middle = {"class": "tick", "text_anchor": "middle"}
        parts += [text(str(k + 1), axes.x(k + 0.5), axes.bottom + 15.0, **middle) for k in range(int(n))]
    parts += [_dot(axes, dot) for dot in dots]
    if name.startswith("gps"):
        low = axes.top - 8.0
        span = axes.y(0.0) - axes.y(GPS_MINIMAL_DIFFERENCE)
        bar = {"stroke": "#222", "stroke_width": 3.0}
        parts.append(straight((axes.right - 2.0, low - span), (axes.right - 2.0, low), **bar))
        least = {"class": "tick", "text_anchor": "end"}
        parts.append(text(f"MCID {GPS_MINIMAL_DIFFERENCE:g} deg", axes.right - 7.0, low, **least))
    return "".join(parts)


def _dot(axes: Axes, dot: _Dot) -> str:
    low, high = axes.y_range
    x, colour = axes.x(dot.place), SIDE.get(dot.side, CENTRE)
    kept = min(max(dot.value, low), high)
    parts = [element("circle", cx=x, cy=axes.y(kept), r=3.5, fill=colour)]
    if dot.sd is not None:
        ends = [axes.y(min(max(dot.value + s * dot.sd, low), high)) for s in (-1.0, 1.0)]
        parts.append(straight((x, ends[0]), (x, ends[1]), stroke=colour, stroke_width=1.4))
    if kept != dot.value:
        parts.append(text("↑" if dot.value > high else "↓", x + 4.0, axes.y(kept) + 4.0, **{"class": "tick"}))
    return "".join(parts)


def _names(comparison: Comparison, y: float) -> str:
    key = [rectangle(66.0 + 80.0 * k, y - 10.0, 14.0, 10.0, fill=colour) for k, colour in enumerate(SIDE.values())]
    key += [text(side, 85.0 + 80.0 * k, y, **{"class": "title"}) for k, side in enumerate(SIDE)]
    key.append(
        text("dot: mean of the cycles, line: ± 1 SD between cycles; fixed scales", 240.0, y, **{"class": "note"})
    )
    members = comparison.members
    if len(members) > MOST_LABELS:
        words = f"{len(members)} results from left to right in the order of the tables"
        return "".join(key) + text(words, 66.0, y + 20.0, **{"class": "note"})
    lines = [
        f"{k + 1}: {_short(m.label, 60)}" + (f" ({m.group})" if m.group != m.label else "")
        for k, m in enumerate(members)
    ]
    return "".join(key) + "".join(text(line, 66.0, y + 20.0 + 16.0 * k) for k, line in enumerate(lines))


def weights_figure(series: Sequence[WeightSeries]) -> str:
    """Parallel plot of the weights: a line per result, bars of ± 1 SD, hollow where not identifiable."""
    names = list(dict.fromkeys(name for one in series for name in one.weights))
    axes = Axes(left=66.0, top=36.0, width=910.0, height=300.0, x_range=(0.0, float(len(names))), y_range=(0.0, 1.0))
    middle = {"class": "title", "text_anchor": "middle"}
    parts = [frame(axes, (), (0.0, 0.2, 0.4, 0.6, 0.8, 1.0))]
    parts += [text(spoken(name), axes.x(k + 0.5), axes.bottom + 18.0, **middle) for k, name in enumerate(names)]
    parts.append(text("weight (normalised, all sum to 1)", axes.left, axes.top - 10.0, **{"class": "title"}))
    for index, one in enumerate(series):
        parts.append(_weight_line(axes, one, names, index, len(series)))
    y = axes.bottom + 44.0
    note = (
        "dot: weight, bar: ± 1 SD, hollow: not identifiable, cross: not converged; a share of a model's cost, no cause"
    )
    parts.append(text(note, axes.left, y, **{"class": "note"}))
    labelled = series if len(series) <= MOST_LABELS else ()
    for index, one in enumerate(labelled):
        row = y + 20.0 + 16.0 * index
        line = {"stroke": "#222", "stroke_width": 1.8, "stroke_dasharray": DASHES[index % len(DASHES)]}
        parts.append(straight((axes.left, row - 4.0), (axes.left + 44.0, row - 4.0), **line))
        state = "" if one.converged else ", not converged"
        parts.append(text(f"{_short(one.label, 60)}{state}", axes.left + 50.0, row))
    return _standalone(y + 40.0 + 16.0 * len(labelled), "".join(parts), "Weights of the criteria")


def _weight_line(axes: Axes, one: WeightSeries, names: Sequence[str], index: int, count: int) -> str:
    shift = 0.3 * (index - (count - 1) / 2.0) / max(count, 1)
    places = [axes.x(k + 0.5 + shift) for k in range(len(names))]
    heights = [axes.y(one.weights[name].weight) if name in one.weights else np.nan for name in names]
    points = [(x, y) for x, y in zip(places, heights, strict=True) if np.isfinite(y)]
    style = {"stroke": "#5b6672", "stroke_width": 1.2, "stroke_dasharray": DASHES[index % len(DASHES)]}
    parts = [straight(a, b, **style) for a, b in zip(points, points[1:], strict=False)]
    for x, name in zip(places, names, strict=True):
        if name not in one.weights:
            continue
        found = one.weights[name]
        y = axes.y(found.weight)
        if found.sd is not None:
            ends = [axes.y(min(max(found.weight + s * found.sd, 0.0), 1.0)) for s in (-1.0, 1.0)]
            parts.append(straight((x, ends[0]), (x, ends[1]), stroke="#222", stroke_width=1.6))
        fill = "#222" if found.identifiable else "#fff"
        parts.append(element("circle", cx=x, cy=y, r=4.0, fill=fill, stroke="#222", stroke_width=1.4))
        if not one.converged:
            cross = {"stroke": "#a3161b", "stroke_width": 2.0}
            parts.append(straight((x - 5.0, y - 5.0), (x + 5.0, y + 5.0), **cross))
            parts.append(straight((x - 5.0, y + 5.0), (x + 5.0, y - 5.0), **cross))
    return "".join(parts)


def _short(words: str, most: int) -> str:
    return words if len(words) <= most else "…" + words[-(most - 1) :]


def _standalone(height: float, content: str, title: str) -> str:
    background = rectangle(0.0, 0.0, _WIDTH, height, fill="#fff")
    return standalone(figure(_WIDTH, height, background + content, title))
