"""Parts of the thesis's gait as a lower level; the full-size solves are in tests/pipelines/test_gait_benchmark.py."""

from dataclasses import replace

import numpy as np
import pytest

from gaitlab.multibody.kinematics import point_positions
from gaitlab.pipelines.gait_benchmark_data import after_impact, in_order
from gaitlab.pipelines.gait_cases import load_case
from gaitlab.walking.gait_courses import courses
from gaitlab.walking.gait_data import MeasuredGait
from gaitlab.walking.point_foot_gait import GaitLevel


@pytest.fixture(scope="module", params=["cp-child", "able-bodied-child"])
def case(request):
    return load_case(request.param)


@pytest.fixture(scope="module")
def level(case):
    return GaitLevel(case.gait, case.measured(1.0, 0))


def test_sizes_are_those_of_the_thesis(case):
    grids = {"cp-child": (24, 28, 10), "able-bodied-child": (35, 60, 20)}
    assert case.gait.n_intervals == grids[case.thesis.name]
    assert tuple(len(q) - 1 for q in case.q) == case.gait.n_intervals
    np.testing.assert_allclose(case.weights.sum(), 1.0)


def test_the_standing_toe_stays_where_it_is(case):
    subject = case.gait.subject
    for ends, toe in zip(case.gait.states, ("right_toe", "left_toe", "right_toe"), strict=True):
        places = point_positions(subject, subject.contacts, ends[:, : subject.n_q])[toe]
        np.testing.assert_allclose(places[0], places[1], atol=1e-9)
        np.testing.assert_allclose(places[:, 2], 0.0, atol=1e-9)


@pytest.mark.parametrize(("stage", "point"), [(0, "left_toe"), (1, "right_toe")])
def test_velocities_jump_by_the_law_of_impact(case, stage, point):
    before, after = case.gait.states[stage, 1], case.gait.states[stage + 1, 0]
    expected = after_impact(in_order(case.gait.subject), before, point)
    n_q = case.gait.subject.n_q
    np.testing.assert_allclose(after[n_q:], expected[n_q:], atol=1e-9)
    assert np.abs(after[n_q:] - before[n_q:]).max() > 0.5


def test_the_jacobian_of_the_cost_is_that_of_finite_differences(level):
    start, theta = level.at_start(np.zeros(4)), np.array([0.4, 0.3, 0.2, 0.1])
    problem, x = level.problems(theta)[2], start.solutions[2]
    zero = np.zeros(problem.structure.n_g), np.zeros(problem.structure.n_c)
    direction = np.random.default_rng(0).standard_normal(x.w.size)
    h = 1e-7
    difference = (problem.values(x.w + h * direction).f - problem.values(x.w - h * direction).f) / (2 * h)
    assert problem.derivatives(x.w, *zero).grad @ direction == pytest.approx(difference, rel=1e-5)


def test_courses_hold_every_stage(level, case):
    course = courses(level.at_start(np.zeros(4)))
    assert [len(t) - 1 for t in course.times] == list(case.gait.n_intervals)
    assert [t.shape[1] for t in course.torques] == [18, 18, 18]
    assert course.joints[0].shape[1:] == (5, 3)


def test_criteria_of_weights_add_up(level, case):
    problems = level.problems(np.array([1.0, 0.0, 0.0, 0.0]))
    start = level.at_start(np.zeros(4))
    expected = start.criteria()[0] / case.gait.normalisers[0]
    found = 0.0
    for problem, x in zip(problems, start.solutions, strict=True):
        without = replace(problem.data, theta=np.zeros_like(problem.data.theta))
        found += problem.values(x.w).f - replace(problem, data=without).values(x.w).f
    floor = case.gait.torque_floor * start.criteria()[1] / case.gait.normalisers[1]
    assert found == pytest.approx(expected + floor, rel=1e-9)


def test_a_measured_gait_keeps_its_shapes(case):
    measured = case.measured(0.0, 3)
    assert isinstance(measured, MeasuredGait)
    for q, truth in zip(measured.q, case.q, strict=True):
        np.testing.assert_array_equal(q, truth)
