"""Gait cycles: from one foot strike to the next of the same foot."""

from collections.abc import Sequence

import numpy as np

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.cycle import Cycle
from gaitlab.mocap.labels import LOWER_BODY
from gaitlab.mocap.recording import Event, EventKind, Recording, Side
from gaitlab.signal.gaps import fill_gaps

SHORTEST, LONGEST = 0.3, 4.0  # s; running children and very slow patients


def cycles(events: Sequence[Event], side: Side) -> tuple[Cycle, ...]:
    """All full strides of one side, in time order.

    Between two strikes there may be at most one foot off of the side: two of them mean that a strike was missed.

    Args:
        events: Events of both sides, in any order.
        side: Which foot.
    """
    opposite: Side = "right" if side == "left" else "left"
    strikes = _times(events, side, "foot_strike")
    found: list[Cycle] = []
    for start, end in zip(strikes, strikes[1:], strict=False):
        offs = _between(_times(events, side, "foot_off"), start, end)
        if not SHORTEST <= end - start <= LONGEST or len(offs) > 1:
            continue
        found.append(
            Cycle(
                side=side,
                start=start,
                end=end,
                foot_off=_first(offs),
                opposite_foot_off=_first(_between(_times(events, opposite, "foot_off"), start, end)),
                opposite_foot_strike=_first(_between(_times(events, opposite, "foot_strike"), start, end)),
            )
        )
    return tuple(found)


def full_strides(name: str, events: Sequence[Event]) -> tuple[Cycle, ...]:
    """All full strides of both sides, in time order.

    Raises:
        InvalidRecording: There is none.
    """
    both = (*cycles(events, "left"), *cycles(events, "right"))
    if not both:
        raise InvalidRecording(
            f"{name}: the trial holds no full stride (two foot strikes of the same foot; found {len(events)} events); "
            "give a longer walk"
        )
    return tuple(sorted(both, key=lambda cycle: cycle.start))


def visible_strides(
    recording: Recording, strides: Sequence[Cycle], required: Sequence[str] = LOWER_BODY
) -> tuple[tuple[Cycle, ...], tuple[str, ...]]:
    """The strides in which all required markers are seen, short gaps being filled, and a warning for each other one.

    Args:
        recording: The trial.
        strides: Its strides.
        required: Canonical marker names; SACR or LPSI and RPSI are added.

    Raises:
        InvalidRecording: No stride is left.
    """
    pelvis = ("SACR",) if "SACR" in recording.markers else ("LPSI", "RPSI")
    names = [*required, *pelvis]
    filled, _ = fill_gaps({n: recording.markers[n] for n in names if n in recording.markers}, recording.rate)
    usable: list[Cycle] = []
    warnings: list[str] = []
    for stride in strides:
        frames = slice(int(np.ceil(stride.start * recording.rate)), int(stride.end * recording.rate) + 1)
        hidden = [n for n in names if n not in filled or not np.isfinite(filled[n][frames]).all()]
        if hidden:
            warnings.append(
                f"{recording.name}: the {stride.side} stride at {stride.start:.2f}-{stride.end:.2f} s is incomplete: "
                f"{', '.join(hidden)} missing"
            )
        else:
            usable.append(stride)
    if strides and not usable:
        raise InvalidRecording(
            f"{recording.name}: markers are missing for too long in every stride ({warnings[0].partition(': ')[2]}); "
            "fill the gaps in the capture software or give another trial"
        )
    return tuple(usable), tuple(warnings)


def _times(events: Sequence[Event], side: Side, kind: EventKind) -> list[float]:
    return sorted(event.time for event in events if event.side == side and event.kind == kind)


def _between(times: Sequence[float], start: float, end: float) -> list[float]:
    return [time for time in times if start < time < end]


def _first(times: Sequence[float]) -> float | None:
    return times[0] if times else None
