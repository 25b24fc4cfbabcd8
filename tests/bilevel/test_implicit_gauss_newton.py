"""The upper level where the lower level's solution is a formula."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize
from weighted_level import WeightedLevel

from gaitlab.bilevel.implicit_gauss_newton import ImplicitGaussNewton
from gaitlab.errors import Cancelled, ProblemError
from gaitlab.nlp.sparse_solution import Status

CENTRE = np.full(3, 1.0 / 3.0)
STIFFNESS = np.array([[1.0, 2.0, 0.5, 3.0], [2.0, 1.0, 1.0, 0.3], [0.4, 1.0, 4.0, 1.0]])
POINTS = np.array([[1.0, 0.0, -1.0, 2.0], [0.0, 2.0, 1.0, -1.0], [-1.0, 1.0, 0.5, 0.0]])


def unit_level(measured):
    """Its solution is theta itself, so that the best weights are the nearest point of the simplex."""
    return WeightedLevel(np.eye(3), np.ones((3, 3)), measured)


def curved_level(measured):
    return WeightedLevel(POINTS, STIFFNESS, measured)


def solve(level, start=CENTRE, progress=None):
    return ImplicitGaussNewton().solve(level, start, level.from_scratch(start), progress)


@pytest.mark.parametrize(
    ("measured", "nearest"),
    [
        ((0.5, 0.6, 0.4), (1 / 3, 13 / 30, 7 / 30)),
        ((0.6, 0.7, -0.5), (0.45, 0.55, 0.0)),
        ((2.0, 0.1, 0.0), (1.0, 0.0, 0.0)),
    ],
    ids=["inside", "face", "vertex"],
)
def test_linear_response_gives_the_nearest_point_of_the_simplex(measured, nearest):
    estimate = solve(unit_level(measured))
    np.testing.assert_allclose(estimate.theta, nearest, atol=1e-5)
    assert estimate.converged


@pytest.mark.parametrize("truth", [(0.2, 0.5, 0.3), (0.7, 0.3, 0.0), (0.0, 0.0, 1.0)])
def test_weights_behind_exact_data_are_found_again(truth):
    estimate = solve(curved_level(curved_level(np.zeros(4)).exact(truth)))
    np.testing.assert_allclose(estimate.theta, truth, atol=1e-5)
    assert estimate.converged


@pytest.mark.parametrize("misfit", [0.3, 1.0, 3.0])
def test_large_residuals_converge_to_the_minimum(misfit):
    """Truth: a general-purpose optimiser on the formula."""
    level = curved_level(curved_level(np.zeros(4)).exact((0.3, 0.4, 0.3)) + misfit * np.array([0.5, -1.0, 1.0, 0.7]))
    options = {"method": "SLSQP", "bounds": [(0, 1)] * 3, "tol": 1e-14}
    sum_is_one = {"type": "eq", "fun": lambda theta: theta.sum() - 1.0}
    found = minimize(level.loss, CENTRE, constraints=sum_is_one, **options)
    estimate = solve(level)
    np.testing.assert_allclose(estimate.theta, found.x, atol=1e-3)
    assert 0.5 * estimate.response.residual @ estimate.response.residual <= found.fun * (1 + 1e-6)
    assert estimate.converged
    assert estimate.iterations <= 15


@pytest.mark.parametrize("theta", [(0.5, 0.6, 0.0), (1.2, -0.2, 0.0), (0.5, 0.5)])
def test_weights_must_lie_on_the_simplex(theta):
    level = unit_level((0.2, 0.3, 0.5))
    with pytest.raises(ProblemError, match="sum 1"):
        ImplicitGaussNewton().solve(level, np.array(theta), level.from_scratch(CENTRE))


class Timid(WeightedLevel):
    """Solves only within `reach` of the weights solved last."""

    reach = 0.1

    def respond(self, theta, start):
        last = self.asked[-1] if self.asked else CENTRE
        response = super().respond(theta, start)
        if np.abs(theta - last).max() > self.reach:
            self.asked.pop()
            response.solution = replace(response.solution, status=Status.ITERATION_LIMIT)
        return response


def test_failures_of_the_lower_level_are_survived():
    truth = (0.75, 0.05, 0.2)
    level = Timid(POINTS, STIFFNESS, curved_level(np.zeros(4)).exact(truth))
    estimate = solve(level)
    np.testing.assert_allclose(estimate.theta, truth, atol=1e-4)
    assert len(level.asked) > 3


def test_iteration_limit_is_not_convergence():
    level = curved_level(curved_level(np.zeros(4)).exact((0.8, 0.1, 0.1)))
    estimate = ImplicitGaussNewton(max_iter=1).solve(level, CENTRE, level.from_scratch(CENTRE))
    assert not estimate.converged
    assert estimate.reason == "iteration limit reached"


def test_progress_cancels():
    def progress(iteration, rms):
        assert rms > 0.0
        if iteration == 1:
            raise Cancelled("enough")

    level = curved_level(np.array([1.0, -1.0, 2.0, 0.0]))
    with pytest.raises(Cancelled):
        solve(level, progress=progress)
    assert level.asked


def test_a_lower_level_that_never_solves_is_not_called_converged():
    level = WeightedLevel([[0.0, 0.0], [1.0, 0.0]], np.ones((2, 2)), [0.8, 0.1])
    start = level.from_scratch(np.array([0.5, 0.5]))
    level.respond = lambda theta, _: SimpleNamespace(
        solution=replace(start.solution, status=Status.STALLED), residual=start.residual
    )
    estimate = ImplicitGaussNewton().solve(level, np.array([0.5, 0.5]), start)
    assert not estimate.converged
    assert "not solved" in estimate.reason
