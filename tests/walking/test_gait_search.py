"""First estimate of the weights of a gait; the whole search is in tests/pipelines/test_gait_benchmark.py."""

from dataclasses import replace

import numpy as np
import pytest

from gaitlab.nlp.sparse_solution import Status
from gaitlab.pipelines.gait_cases import load_case
from gaitlab.walking.gait_search import first_estimate
from gaitlab.walking.point_foot_gait import GaitLevel


@pytest.fixture(scope="module")
def estimate():
    case = load_case("cp-child")
    level = GaitLevel(case.gait, case.measured(1.0, 0))
    return case, level, *first_estimate(level, np.full(4, 0.25))


def test_the_first_estimate_is_near_the_truth(estimate):
    case, _, theta, optimum = estimate
    assert optimum.solution.status is Status.SOLVED
    assert theta.sum() == pytest.approx(1.0)
    assert np.max(np.abs(theta - case.weights)) <= 0.05


def test_its_optimum_is_solved_without_tracking(estimate):
    _, level, theta, optimum = estimate
    for ours, again in zip(optimum.problems, level.problems(theta), strict=True):
        assert np.all(ours.data.tracking == 0.0)
        np.testing.assert_array_equal(ours.data.theta, again.data.theta)
    assert optimum.solution.residuals.max() <= 1e-6


def test_lost_stages_are_found_again_from_the_tracked_motion(estimate):
    _, level, theta, optimum = estimate
    # A start that is no prediction at all.
    far = replace(optimum.solution, w=optimum.solution.w + 0.1, lam_g=np.zeros_like(optimum.solution.lam_g))
    again = level.respond(theta, far)
    assert again.solution.status is Status.SOLVED
    assert again.solution.f <= optimum.solution.f * (1.0 + 1e-3)
