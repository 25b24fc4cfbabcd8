"""When a muscle is active during the gait cycle, judged from its mean envelope."""

import numpy as np

from ..signal.runs import runs
from .cycle_average import N_SAMPLES

THRESHOLD = 0.25
"""Part of the way from the lowest to the largest mean value above which a muscle counts as active."""
FLATTEST = 1.0 / 3.0
"""Lowest over largest value above which a channel is not judged: it is noise, or a muscle that never rests."""
SHORTEST = 5
"""Percent of the cycle: shorter bursts are not activity, shorter pauses do not end it."""
RULE = (
    f"bars: the mean envelope is more than {100.0 * THRESHOLD:.0f} % of the way up from its lowest to its largest "
    f"value over the cycle; pauses and then bursts shorter than {SHORTEST} % of the closed cycle do not count; "
    f"a channel whose lowest value is above a third of its largest has no bars. Another threshold "
    "moves their ends"
)
Span = tuple[float, float]
"""Start and end [%]."""


def active_spans(envelope: np.ndarray) -> list[Span]:
    """Parts of the cycle in which a muscle is active, in time order, by `RULE`.

    Args:
        envelope: Mean envelope over the cycle, 0 to 100 %, any unit, shape (101,).

    Returns:
        Start and end of each [%]; a span over the end of the cycle is given as two. Empty when a value is unknown
        or the channel is too flat to judge.
    """
    if envelope.shape != (N_SAMPLES,) or not np.all(np.isfinite(envelope)):
        return []
    low, high = float(envelope.min()), float(envelope.max())
    if low >= FLATTEST * high:
        return []
    once_around = envelope[:-1] > low + THRESHOLD * (high - low)  # sample 100 is sample 0 of the next cycle
    active = ~_without_short(~once_around)
    active = _without_short(active)
    return [(float(start), float(end)) for start, end in runs(active)]


def _without_short(on: np.ndarray) -> np.ndarray:
    """Runs of True of a closed cycle that last long enough, shape (100,)."""
    if on.all() or not on.any():
        return on
    first = int(np.flatnonzero(~on)[0])
    turned = np.roll(on, -first)  # begins with False, so no run goes over the end
    for start, end in runs(turned):
        if end - start < SHORTEST:
            turned[start:end] = False
    return np.roll(turned, first)
