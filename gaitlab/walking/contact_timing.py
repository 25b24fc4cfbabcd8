"""Stages long enough for an interval or two, as close as possible to what was seen.

Among all sequences of stages of constant (right, left) state, each of at least so many frames, take the one with the
least total disagreement with the observed phases. Dynamic programming over the frames finds it exactly.
"""

from itertools import product

import numpy as np

from .contact_phases import FREE, HEEL, STATES, TOE

PAIRS = tuple(product(STATES, STATES))
"""States of (right, left)."""

SUPPORT_COST = 4.0
"""Per frame and foot that stands where it was seen free or the reverse; a stance's part that differs costs 1. Hence
foot strike and foot off keep their frame unless four frames of heel, flat or toe would have to give way."""

SWITCH_COST = 0.5
"""Per stage: of two equally close sequences the one with fewer stages is taken."""

FORBIDDEN = 1e6


def closest_stages(phases: np.ndarray, shortest: int, shortest_flight: int) -> list[tuple[tuple[str, str], int]]:
    """States and numbers of frames of the stages that agree best with phases of shape (n, 2).

    Args:
        phases: States of the right and left foot.
        shortest: Fewest frames of a stage, at most n.
        shortest_flight: Runs of frames in which neither foot stands count as flight from this length on; shorter
            ones are errors of the events, and one of the feet is taken to stand.
    """
    n = len(phases)
    total = np.concatenate([np.zeros((1, len(PAIRS))), np.cumsum(_costs(phases, shortest_flight), axis=0)])
    switch = np.where(_allowed(), SWITCH_COST, FORBIDDEN)  # (before, after)
    ended = np.full((n + 1, len(PAIRS)), np.inf)  # least cost of frames < t when a stage of this state ends at t
    begun = np.full((n + 1, len(PAIRS)), np.inf)  # the same when one begins at t
    before = np.zeros((n + 1, len(PAIRS)), dtype=int)  # state of the stage that ends where this one begins
    start = np.zeros((n + 1, len(PAIRS)), dtype=int)  # where the stage that ends at t began
    begun[0] = 0.0
    for t in range(shortest, n + 1):
        relative = begun[: t - shortest + 1] - total[: t - shortest + 1]
        start[t] = np.argmin(relative, axis=0)
        ended[t] = relative[start[t], np.arange(len(PAIRS))] + total[t]
        through = ended[t][:, None] + switch
        before[t] = np.argmin(through, axis=0)
        begun[t] = through[before[t], np.arange(len(PAIRS))]
    return _trace_back(ended, before, start)


def _trace_back(ended: np.ndarray, before: np.ndarray, start: np.ndarray) -> list[tuple[tuple[str, str], int]]:
    stages: list[tuple[tuple[str, str], int]] = []
    t, state = len(ended) - 1, int(np.argmin(ended[-1]))
    while t > 0:
        begin = int(start[t, state])
        stages.append((PAIRS[state], t - begin))
        t, state = begin, int(before[begin, state])
    return stages[::-1]


def _costs(phases: np.ndarray, shortest_flight: int) -> np.ndarray:
    """Disagreement of every pair of states with every frame, shape (n, 16)."""
    pairs = np.array(PAIRS)  # (16, 2)
    different = phases[:, None] != pairs  # (n, 16, 2)
    support = (phases == FREE)[:, None] != (pairs == FREE)
    costs = np.where(support, SUPPORT_COST, different.astype(float)).sum(axis=2)
    flight = long_runs((phases == FREE).all(axis=1), shortest_flight)
    costs[np.ix_(~flight, (pairs == FREE).all(axis=1))] = FORBIDDEN
    return costs


def long_runs(flags: np.ndarray, shortest: int) -> np.ndarray:
    """Flags (n,) without the runs that are shorter than `shortest`."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    kept = np.zeros_like(flags)
    for begin, end in edges.reshape(-1, 2):
        kept[begin:end] = end - begin >= shortest
    return kept


def _allowed() -> np.ndarray:
    """Which pair of states may follow which: another one, and no foot from heel to toe or back without being flat."""
    return np.array(
        [
            [a != b and all(_may_follow(x, y) for x, y in zip(a, b, strict=True)) for b in PAIRS]
            for a in PAIRS
        ]
    )  # fmt: skip


def _may_follow(before: str, after: str) -> bool:
    return {before, after} != {HEEL, TOE}
