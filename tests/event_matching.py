"""One-to-one matching of detected with true events."""

from collections.abc import Sequence

import numpy as np

from gaitlab.mocap.recording import Event

WINDOW = 0.15  # s; farther apart, the true event is missed and the detected one false


def match_events(
    true: Sequence[Event], found: Sequence[Event], start: float, end: float
) -> tuple[np.ndarray, list[Event], list[Event]]:
    """Errors [s] of the matched events between start and end, missed and false events there.

    A detection is false only within the span of the true events of its side: files are not annotated to their ends.
    """
    pairs = sorted(
        (abs(b.time - a.time), i, j)
        for i, a in enumerate(true)
        for j, b in enumerate(found)
        if (a.side, a.kind) == (b.side, b.kind) and abs(b.time - a.time) <= WINDOW
    )
    partner: dict[int, int] = {}
    for _, i, j in pairs:
        if i not in partner and j not in partner.values():
            partner[i] = j
    inside = [i for i, event in enumerate(true) if start <= event.time <= end]
    errors = [found[partner[i]].time - true[i].time for i in inside if i in partner]
    missed = [true[i] for i in inside if i not in partner]
    free = [event for j, event in enumerate(found) if j not in partner.values() and start <= event.time <= end]
    return np.array(errors), missed, [event for event in free if _annotated(event, true)]


def _annotated(event: Event, true: Sequence[Event]) -> bool:
    times = [other.time for other in true if other.side == event.side]
    return bool(times) and min(times) <= event.time <= max(times)
