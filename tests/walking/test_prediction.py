"""The identified gait as a member of the family of predictions, and small changes of it."""

import numpy as np
import pytest
from identified_demo import identified_demo

from gaitlab.errors import NotConverged
from gaitlab.walking.identified_gait import read_gait, write_gait
from gaitlab.walking.prediction import PredictionSettings, predict
from gaitlab.walking.prediction_problem import HabitSettings
from gaitlab.walking.quantities import Present
from gaitlab.walking.request import parse_request

QUICK = PredictionSettings(habit=HabitSettings(angle=40.0), margin=1.0, first_step=1.0)


@pytest.fixture(scope="module")
def gait():
    return identified_demo()


@pytest.fixture(scope="module")
def predicted(gait):
    def call(*assignments, settings=QUICK):
        return predict(gait, parse_request(assignments, Present(gait)).situation, settings)

    return call


def states(step):
    family = step.point.family
    return family.gait.problem.states(step.point.solution.w)


@pytest.fixture(scope="module")
def same(predicted):
    return predicted()


def test_the_identified_gait_satisfies_the_conditions_of_the_prediction(same):
    start = same.steps[0]
    assert start.residual < 1e-6
    assert start.is_certified


def test_unchanged_body_and_task_return_the_identified_gait(same, gait):
    assert same.is_complete
    assert np.abs(states(same.steps[-1]) - gait.states).max() < 1e-6
    assert same.steps[-1].time == pytest.approx(gait.duration, abs=1e-7)
    assert same.steps[-1].length == pytest.approx(gait.length, abs=1e-7)


def test_derivatives_of_periodicity_and_stride_time_are_symmetric(same):
    """They are second derivatives of one function, found on different ways."""
    jacobian = same.steps[0].point.jacobian
    assert np.abs(jacobian - jacobian.T).max() < 1e-8 * np.abs(jacobian).max()


def test_a_little_faster(predicted, gait):
    """Along the path speed is met exactly, and the stride ends as it began."""
    found = predicted("speed=+1%")
    end = found.steps[-1]
    assert found.is_complete, found.reason
    assert end.is_certified
    assert end.length / end.time == pytest.approx(1.01 * gait.length / gait.duration, rel=1e-9)
    x = states(end)
    apart, before = x[-1] - x[0], gait.states[-1] - gait.states[0]
    assert np.abs(apart[1:24] - before[1:24]).max() < 1e-4
    assert apart[0] == pytest.approx(end.length, abs=1e-6)
    assert end.time < gait.duration
    assert end.length > gait.length


def test_what_weighs_more_becomes_less(predicted, gait):
    """Of minima of weighted sums: the changes of weights times those of the criteria, per distance, are negative."""
    found = predicted("torque_weight=0.3")
    end = found.steps[-1]
    assert found.is_complete, found.reason
    assert end.is_certified
    criteria = [
        step.point.family.mechanical(step.point.situation, step.point.outer.log_time).criteria(step.point.solution.w)
        * gait.length
        / step.length
        for step in (found.steps[0], end)
    ]
    product = (end.point.situation.weights - gait.weights) @ ((criteria[1] - criteria[0])[:4] / gait.normalisers)
    assert product < -1e-6
    assert criteria[1][1] < criteria[0][1]


def test_a_torque_limit_is_kept(predicted, gait):
    name = "right_ankle_plantarflexor_limit"
    limit = parse_request([f"{name}=-3%"], Present(gait)).values[name]
    end = predicted(f"{name}=-3%").steps[-1]
    torque = end.point.family.mechanical(end.point.situation, end.point.outer.log_time).outputs(end.point.solution.w)
    assert end.share == 1.0
    assert torque[:, 12].max() <= limit + 1e-6


def test_a_habit_that_may_not_be_firm_enough_is_said(gait):
    soft = PredictionSettings(habit=HabitSettings(angle=1e-3), firmest=1e-2)
    with pytest.raises(NotConverged, match="no strict minimum"):
        predict(gait, parse_request([], Present(gait)).situation, soft)


def test_a_gait_in_a_file_is_the_same(gait, tmp_path):
    write_gait(gait, tmp_path / "identified.npz")
    again = read_gait(tmp_path / "identified.npz")
    assert np.array_equal(again.states, gait.states)
    assert again.solution.residuals.max() == pytest.approx(gait.solution.residuals.max(), rel=1e-6)
    assert again.criteria == gait.criteria
