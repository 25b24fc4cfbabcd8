"""Dynamic programming against trying out every sequence of stages."""

from itertools import groupby, product

import numpy as np
import pytest

from gaitlab.walking.contact_timing import PAIRS, SUPPORT_COST, SWITCH_COST, closest_stages

LENGTHS = [(6,), (2, 4), (3, 3), (4, 2), (2, 2, 2)]


def cost(phases, stages):
    labels = [pair for pair, n in stages for _ in range(n)]
    total = SWITCH_COST * (len(stages) - 1)
    for seen, pair in zip(phases, labels, strict=True):
        for a, b in zip(seen, pair, strict=True):
            total += 0.0 if a == b else SUPPORT_COST if "free" in (a, b) else 1.0
    return total


def legal(pairs):
    if ("free", "free") in pairs or any(a == b for a, b in zip(pairs, pairs[1:], strict=False)):
        return False
    return not any({a[k], b[k]} == {"heel", "toe"} for a, b in zip(pairs, pairs[1:], strict=False) for k in (0, 1))


@pytest.mark.parametrize("seed", range(4))
def test_no_legal_sequence_is_closer(seed):
    phases = np.array(PAIRS)[np.sort(np.random.default_rng(seed).integers(16, size=6))]
    found = closest_stages(phases, shortest=2, shortest_flight=6)
    candidates = (
        list(zip(pairs, lengths, strict=True))
        for lengths in LENGTHS
        for pairs in product(PAIRS, repeat=len(lengths))
        if legal(pairs)
    )
    assert legal([pair for pair, _ in found])
    assert cost(phases, found) == pytest.approx(min(cost(phases, stages) for stages in candidates))


def test_runs_that_are_long_enough_stay_as_they_are():
    pairs = [("heel", "toe"), ("flat", "free"), ("toe", "free"), ("free", "free"), ("free", "heel")]
    phases = np.repeat(np.array(pairs), 6, axis=0)
    assert closest_stages(phases, shortest=4, shortest_flight=6) == [(pair, 6) for pair in pairs]


def test_a_short_flight_becomes_support():
    phases = np.repeat(np.array([("toe", "free"), ("free", "free"), ("free", "heel")]), [10, 3, 10], axis=0)
    found = closest_stages(phases, shortest=4, shortest_flight=6)
    assert [pair for pair, _ in found] == [("toe", "free"), ("free", "heel")]
    assert sum(n for _, n in found) == 23


def test_a_foot_is_flat_between_heel_and_toe():
    phases = np.repeat(np.array([("heel", "free"), ("toe", "free")]), 10, axis=0)
    found = closest_stages(phases, shortest=4, shortest_flight=6)
    assert [pair[0] for pair, _ in found] == ["heel", "flat", "toe"]
    assert found[1][1] == 4


def test_strikes_and_offs_move_less_than_parts_of_a_stance():
    """Three frames of heel before the other foot leaves: the heel's end gives way, the foot off does not."""
    phases = np.repeat(np.array([("heel", "toe"), ("flat", "toe"), ("flat", "free")]), [8, 3, 10], axis=0)
    found = closest_stages(phases, shortest=4, shortest_flight=6)
    left = [pair[1] for pair, n in found for _ in range(n)]
    assert [(state, len(list(run))) for state, run in groupby(left)] == [("toe", 11), ("free", 10)]
