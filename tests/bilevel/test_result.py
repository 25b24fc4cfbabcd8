"""What an estimate says about itself, where the answer is a formula."""

import numpy as np
import pytest
from weighted_level import WeightedLevel

from gaitlab.bilevel.implicit_gauss_newton import ImplicitGaussNewton
from gaitlab.bilevel.result import rms


@pytest.fixture(scope="module")
def estimate():
    """Solution theta itself; the data lie 0.1 above the simplex in every coordinate."""
    level = WeightedLevel(np.eye(3), np.ones((3, 3)), np.array([0.3, 0.4, 0.6]))
    theta = np.full(3, 1.0 / 3.0)
    return ImplicitGaussNewton().solve(level, theta, level.from_scratch(theta))


def test_rms_of_a_vector():
    assert rms(np.array([3.0, -4.0, 0.0, 0.0])) == pytest.approx(2.5)


def test_fit_is_the_distance_to_the_data(estimate):
    np.testing.assert_allclose(estimate.theta, [0.2, 0.3, 0.5], atol=1e-5)
    assert estimate.rms == pytest.approx(0.1, rel=1e-6)


def test_response_belongs_to_the_weights(estimate):
    np.testing.assert_allclose(estimate.response.solution.w, estimate.theta, atol=1e-8)
    assert estimate.response.solution.is_optimal(1e-8)


def test_covariance_of_a_response_that_is_the_weights(estimate):
    """J = I on the simplex: C = kappa s^2 (I - 1/3), s^2 = |r|^2 / (3 - 2); r is constant, so rho = 2/3, kappa = 5."""
    np.testing.assert_allclose(estimate.covariance, 5.0 * 0.03 * (np.eye(3) - 1.0 / 3.0), rtol=1e-4)
    assert estimate.condition == pytest.approx(1.0, rel=1e-6)
