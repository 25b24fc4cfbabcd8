import numpy as np
import pytest

from gaitlab.nlp.filter_search import Filter, Merit, backtrack
from gaitlab.nlp.sparse_problem import Values

MU = 0.1


def merit(violation, barrier):
    return Merit(Values(barrier, np.array([violation]), np.zeros(0)), np.zeros(0), MU)


def test_merit_by_hand():
    found = Merit(Values(2.0, np.array([1.0, -3.0]), np.array([0.5])), np.array([2.0]), MU)
    assert found.violation == pytest.approx(1 + 3 + 1.5)
    assert found.barrier == pytest.approx(2.0 - MU * np.log(2.0))


def test_a_filter_refuses_what_it_dominates():
    search_filter = Filter()
    assert search_filter.accepts(merit(9.0, 9.0))
    search_filter.add(merit(1.0, 5.0))
    search_filter.add(merit(3.0, 2.0))
    refused = [(1.0, 5.0), (2.0, 6.0), (3.5, 2.5)]
    accepted = [(0.9, 9.0), (2.0, 4.0), (9.0, 1.0)]
    assert not any(search_filter.accepts(merit(*pair)) for pair in refused)
    assert all(search_filter.accepts(merit(*pair)) for pair in accepted)


def test_a_filter_refuses_very_large_violations():
    search_filter = Filter(largest=100.0)
    assert search_filter.accepts(merit(100.0, -1e9))
    assert not search_filter.accepts(merit(100.1, -1e9))


def test_a_filter_forgets_what_a_better_pair_dominates():
    search_filter = Filter()
    for pair in [(1.0, 5.0), (3.0, 2.0), (0.5, 1.0)]:
        search_filter.add(merit(*pair))
    assert search_filter.entries == [(0.5, 1.0)]


def search(function, slope, alpha=1.0, start=0.0):
    """Search along one variable without constraints."""
    nothing = np.zeros(0)

    def trial(step):
        w = np.array([step])
        return w, nothing, Values(function(step), nothing, nothing)

    return backtrack(Filter(), merit(0.0, start), slope, trial, alpha)


def test_full_steps_that_descend_are_taken():
    assert search(lambda step: -step, slope=-1.0)[0] == 1.0


def test_steps_are_halved_until_the_objective_falls():
    """f = 10 s^2 - s falls for s < 0.1."""
    alpha, w, _, values = search(lambda step: 10 * step**2 - step, slope=-1.0)
    assert alpha == w[0] == 0.0625
    assert values.f < 0.0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_points_that_are_not_finite_are_stepped_back_from(bad):
    assert search(lambda step: bad if step > 0.3 else -step, slope=-1.0)[0] == 0.25


def test_ascent_ends_without_a_step():
    assert search(lambda step: step, slope=-1.0) is None


def test_less_violation_is_progress_even_uphill():
    nothing, search_filter = np.zeros(0), Filter()

    def trial(step):
        return np.array([step]), nothing, Values(100.0 * step, np.array([1.0 - step]), nothing)

    start = merit(1.0, 0.0)
    assert backtrack(search_filter, start, 100.0, trial, 1.0)[0] == 1.0
    assert search_filter.entries == [(1.0, 0.0)]
