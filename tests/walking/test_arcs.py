"""Arcs of a demo stride against the whole problem that they are parts of."""

from dataclasses import replace

import numpy as np
import pytest
from demo_stride import demo_stride

from gaitlab.nlp.sparse_solution import Status
from gaitlab.nlp.workers import Workers
from gaitlab.walking.arcs import Attempt, part_of_stages
from gaitlab.walking.identification import AFAR, IdentificationSettings, WalkLevel
from gaitlab.walking.tracking import track

THETA = np.array([0.4, 0.3, 0.2, 0.1])


@pytest.fixture(scope="module")
def level():
    return WalkLevel(track(demo_stride()), IdentificationSettings())


@pytest.fixture(scope="module")
def optimum(level):
    return level.from_tracking(THETA)


def test_parts_make_up_the_whole(level):
    """Cost and constraints of the arcs, at a point that solves nothing, are those of the whole."""
    whole = level.problem(THETA)
    w = level.tracked.solution.w.copy()[: whole.structure.n_w]
    w = np.concatenate([w, np.zeros(whole.structure.n_w - len(w))]) + 0.01 * np.sin(np.arange(whole.structure.n_w))
    expected = whole.values(w)
    cost, seen_g, seen_c = 0.0, [], []
    for arc in level.arcs.parts:
        values = type(whole)(arc.structure, arc.data(whole.data)).values(w[arc.w])
        np.testing.assert_allclose(values.g, expected.g[arc.g], atol=1e-12)
        np.testing.assert_allclose(values.c, expected.c[arc.c], atol=1e-12)
        cost += values.f
        seen_g.append(arc.g)
        seen_c.append(arc.c)
    assert cost == pytest.approx(expected.f, rel=1e-10)
    np.testing.assert_array_equal(np.unique(np.concatenate(seen_g)), np.arange(whole.structure.n_g))
    np.testing.assert_array_equal(np.sort(np.concatenate(seen_c)), np.arange(whole.structure.n_c))


def test_joint_solution_is_certified_on_the_whole_and_found_by_solving_it(level, optimum):
    assert optimum.solution.status is Status.SOLVED
    assert optimum.solution.is_optimal(1e-6)
    method = replace(level.settings.solver, mu_initial=AFAR)
    whole = method.solve(optimum.problem, optimum.solution)
    assert whole.f == pytest.approx(optimum.solution.f, rel=1e-7)
    np.testing.assert_allclose(whole.w, optimum.solution.w, atol=1e-4)


def test_other_processes_find_exactly_the_same(level, optimum):
    with Workers(2) as workers:
        there = WalkLevel(level.tracked, level.settings, workers).from_tracking(THETA)
    np.testing.assert_array_equal(there.solution.w, optimum.solution.w)
    np.testing.assert_array_equal(there.solution.lam_g, optimum.solution.lam_g)


def test_an_optimum_takes_over_the_arcs_that_cost_less(level, optimum):
    """From an optimum for other weights, which is worse everywhere; one arc's better solution is said to be lost."""
    problem, arcs = optimum.problem, level.arcs
    worse = level.respond_from_afar(np.array([0.0, 0.0, 0.0, 1.0]), optimum.solution).solution
    found = arcs.solve_each(problem, (Attempt(level.settings.solver, optimum.solution),))
    found[1] = replace(found[1], status=Status.STALLED)
    joint = arcs.improved(problem, worse, found)
    for k, arc in enumerate(arcs.parts):
        np.testing.assert_allclose(joint.w[arc.w], (worse if k == 1 else optimum.solution).w[arc.w], atol=1e-5)
    whole = arcs.improved(problem, joint, arcs.solve_each(problem, (Attempt(level.settings.solver, optimum.solution),)))
    assert whole.is_optimal(1e-6)
    np.testing.assert_allclose(whole.lam_g, optimum.solution.lam_g, rtol=1e-4, atol=1e-4)


def test_an_optimum_is_kept_where_nothing_is_better(level, optimum):
    again = level.second_look(optimum)
    np.testing.assert_allclose(again.solution.w, optimum.solution.w, atol=1e-5)
    np.testing.assert_allclose(again.solution.lam_g, optimum.solution.lam_g, rtol=1e-4, atol=1e-4)


def test_parts_of_stages_keep_time_and_contacts(level):
    stages = level.tracked.stride.stages
    n = sum(s.n_intervals for s in stages)
    pieces = part_of_stages(stages, 0, 7) + part_of_stages(stages, 7, n)
    assert sum(s.n_intervals for s in pieces) == n
    assert sum(s.duration for s in pieces) == pytest.approx(sum(s.duration for s in stages))
    assert {s.label for s in pieces} == {s.label for s in stages}
