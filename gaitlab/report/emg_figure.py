"""EMG over the gait cycle: envelopes of every channel, and bars of when the muscle is active.

Envelopes have no common unit: each is drawn in percent of the largest mean of its channel. Bars stand above the curves:
the left side's, the right side's and, grey, those of the reference cohort's mean envelope by the same rule.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..clinical.document import SIDES
from ..clinical.muscle_activity import Span, active_spans
from .colours import SIDE
from .cycle_panels import CyclePanel, Marks, averages, cycle_panel, legend, legend_lines, mean_range
from .kinematics_figure import NO_NORMS, Norms
from .result import Curve, Result, mapping, real, sequence
from .svg import Axes, figure, rectangle, text

_WIDTH, _COLUMN, _ROW = 1000.0, 325.0, 150.0
_TOP, _PANEL_WIDTH, _PANEL_HEIGHT = 26.0, 245.0, 94.0
_LEGEND = 132.0
_TOP_OF_SCALE = 160.0  # [%]; curves with their bands reach about 110, bars stand above
_BAR = 5.0
_BAR_ROW = 11.0
"""From one row of bars to the next: the height of a letter."""
_NORM = "#8a949e"


@dataclass(frozen=True, kw_only=True)
class Activity:
    """When muscles are active, what the channels are called in norms, and their units."""

    spans: Mapping[str, Mapping[str, Sequence[Span]]] = field(default_factory=dict[str, Mapping[str, Sequence[Span]]])
    """Label to side to start and end [%]."""
    muscles: Mapping[str, str] = field(default_factory=dict[str, str])
    """Label to the name of its muscle in norms."""
    rule: str = ""
    units: Mapping[str, str] = field(default_factory=dict[str, str])
    """Label to the unit that the file states."""


def activity_of(result: Result) -> Activity:
    """What the document says about the activity of muscles."""
    part = result.part("emg")
    return Activity(
        spans={
            label: {side: _spans(mapping(sides).get(side)) for side in SIDES if side in mapping(sides)}
            for label, sides in mapping(part.get("activity")).items()
        },
        muscles={label: str(muscle) for label, muscle in mapping(part.get("muscles")).items()},
        rule=str(part.get("activity_rule") or ""),
        units={
            label: str(mapping(curve).get("unit") or "file's unit")
            for label, curve in mapping(part.get("envelopes")).items()
        },
    )


def _spans(value: object) -> list[Span]:
    pairs = [[real(end) for end in sequence(pair)] for pair in sequence(value)]
    return [(pair[0], pair[1]) for pair in pairs if len(pair) == 2 and pair[0] is not None and pair[1] is not None]


def emg_figure(
    envelopes: Mapping[str, Mapping[str, Curve]],
    marks: Mapping[str, Marks],
    activity: Activity | None = None,
    norms: Norms = NO_NORMS,
) -> str:
    """Draw the mean envelope of each channel in percent of its own maximum with bars of activity, three in a row.

    `norms` may hold envelopes by the names of muscles among its curves.
    """
    activity = activity or Activity()
    units = {label: activity.units.get(label, "") for label in envelopes}
    panels = [
        _panel(label, curves, index, marks, units[label]) for index, (label, curves) in enumerate(envelopes.items())
    ]
    bars = [_bars(label, index, activity, norms) for index, label in enumerate(envelopes)]
    bottom = _TOP + _ROW * ((len(envelopes) + 2) // 3)
    lines = ("coloured band: ± 1 standard deviation between cycles", *_bar_legend(envelopes, activity, norms))
    words = legend(66.0, bottom + 10.0, (*lines, *legend_lines(marks)))
    return figure(_WIDTH, bottom + _LEGEND, "".join([*panels, *bars, words]), "EMG envelopes over the gait cycle")


def _bar_legend(labels: Mapping[str, object], activity: Activity, norms: Norms) -> tuple[str, ...]:
    if not activity.spans:
        return ("no bars of activity: the result holds none",)
    first = ("bars at the top: when the muscle is active; L left, R right",)
    muscles = {muscle for label, muscle in activity.muscles.items() if label in labels and muscle in norms.curves}
    if not muscles:
        return (*first, "no bars of a reference cohort: it has none of these muscles, or none applies")
    named = ", ".join(sorted(muscle.replace("_", " ") for muscle in muscles))
    return (*first, f"grey bars, N: {norms.description},", f"same rule, of its mean envelope: {named}")


def _axes(index: int) -> Axes:
    row, column = divmod(index, 3)
    corner = {"left": 66.0 + column * _COLUMN, "top": _TOP + row * _ROW}
    size = {"width": _PANEL_WIDTH, "height": _PANEL_HEIGHT}
    return Axes(**corner, **size, x_range=(0.0, 100.0), y_range=(0.0, _TOP_OF_SCALE))


def _panel(label: str, curves: Mapping[str, Curve], index: int, marks: Mapping[str, Marks], unit: str) -> str:
    extent = mean_range(curves)
    highest = extent[1] if extent is not None and extent[1] > 0.0 else 1.0
    panel = CyclePanel(
        name=label, title=label, axes=_axes(index), direction=f"% of {highest:.2g} {unit}".strip(), x_label=True
    )
    own = {side: mark for side, mark in marks.items() if side in curves}
    scaled = {side: _scaled(curve, 100.0 / highest) for side, curve in curves.items()}
    return cycle_panel(panel, averages(panel.axes, scaled), None, own)


def _scaled(curve: Curve, factor: float) -> Curve:
    return Curve(mean=factor * curve.mean, sd=None if curve.sd is None else factor * curve.sd, n_cycles=curve.n_cycles)


def _bars(label: str, index: int, activity: Activity, norms: Norms) -> str:
    axes = _axes(index)
    rows = [(side[0].upper(), SIDE[side], spans) for side, spans in activity.spans.get(label, {}).items()]
    reference = norms.curves.get(activity.muscles.get(label, ""))
    if reference is not None:
        rows.append(("N", _NORM, active_spans(reference.mean)))
    parts = list[str]()
    for number, (letter, colour, spans) in enumerate(rows):
        top = axes.top + 2.0 + _BAR_ROW * number
        parts.append(text(letter, axes.right + 4.0, top + _BAR + 3.0, **{"class": "tick"}, style="font-size:10px"))
        for start, end in spans:
            words = {"fill": colour, "data_bar": letter}
            parts.append(rectangle(axes.x(start), top, axes.x(end) - axes.x(start), _BAR, **words))
    return "".join(parts)
