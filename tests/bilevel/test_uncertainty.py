"""Covariance of weights against Monte Carlo, and what the data do not tell."""

import numpy as np
import pytest

from gaitlab.bilevel.uncertainty import correlation, ellipsoid_holds, inflation, weight_uncertainty

TIMES, CHANNELS = 100, 20


def autoregression(rng, rho, shape):
    """First-order autoregression in time, unit variance."""
    noise = rng.standard_normal(shape)
    for k in range(1, shape[0]):
        noise[k] = rho * noise[k - 1] + np.sqrt(1.0 - rho**2) * noise[k]
    return noise


def restricted_fits(jacobian, noise):
    """Least-squares weights with sum one for many draws of noise, shape (n_draws, n_m); the truth is zero moved."""
    n = jacobian.shape[1]
    saddle = np.block([[jacobian.T @ jacobian, np.ones((n, 1))], [np.ones((1, n)), np.zeros((1, 1))]])
    right = np.vstack([jacobian.T @ noise.T, np.zeros((1, len(noise)))])
    return np.linalg.solve(saddle, right)[:n].T


def test_covariance_is_that_of_repeated_experiments():
    rng = np.random.default_rng(1)
    jacobian = rng.standard_normal((TIMES * CHANNELS, 3)) * [1.0, 2.0, 0.5]
    noise = 0.1 * rng.standard_normal((3000, TIMES * CHANNELS))
    fits = restricted_fits(jacobian, noise)
    predicted = np.mean(
        [
            weight_uncertainty(jacobian, (jacobian @ fit - draw).reshape(TIMES, CHANNELS)).covariance
            for fit, draw in zip(fits[:300], noise[:300], strict=True)
        ],
        axis=0,
    )
    scale = np.sqrt(np.outer(np.diag(predicted), np.diag(predicted)))
    np.testing.assert_allclose(np.cov(fits.T) / scale, predicted / scale, atol=0.1)


def test_covariance_holds_for_noise_correlated_in_time():
    """Where the response is slow, correlated noise averages out less."""
    rng = np.random.default_rng(2)
    jacobian = np.repeat(rng.standard_normal((1, CHANNELS, 3)), 400, axis=0).reshape(-1, 3)
    draws = [autoregression(rng, 0.6, (400, CHANNELS)) for _ in range(400)]
    fits = restricted_fits(jacobian, np.array([draw.ravel() for draw in draws]))
    predicted = weight_uncertainty(jacobian, draws[0]).covariance
    np.testing.assert_allclose(fits.var(axis=0), np.diag(predicted), rtol=0.25)


def test_ellipsoids_hold_the_truth_as_often_as_they_say():
    """Bounds are four standard errors of 400 experiments."""
    rng = np.random.default_rng(4)
    jacobian = rng.standard_normal((TIMES * CHANNELS, 3)) * [1.0, 2.0, 0.5]
    noise = rng.standard_normal((400, TIMES * CHANNELS))
    fits = restricted_fits(jacobian, noise)
    covariance = weight_uncertainty(jacobian, noise[0].reshape(TIMES, CHANNELS)).covariance
    held = {level: np.mean([ellipsoid_holds(gap, covariance, level) for gap in fits]) for level in (0.5, 0.95)}
    assert held[0.95] == pytest.approx(0.95, abs=0.045)
    assert held[0.5] == pytest.approx(0.5, abs=0.1)


def test_blind_weights_do_not_count_in_the_ellipsoid():
    covariance = np.diag([np.inf, 0.01, 0.01])
    assert ellipsoid_holds(np.array([9.0, 0.1, -0.1]), covariance)
    assert not ellipsoid_holds(np.array([0.0, 0.3, -0.3]), covariance)


def test_moves_keep_the_sum_of_the_weights():
    rng = np.random.default_rng(3)
    found = weight_uncertainty(rng.standard_normal((60, 4)), rng.standard_normal((20, 3)))
    np.testing.assert_allclose(found.covariance.sum(axis=0), 0.0, atol=1e-12)


def test_blind_directions_have_infinite_variance():
    """The first two criteria move the walk alike, so the data tell only their sum."""
    rng = np.random.default_rng(4)
    columns = rng.standard_normal((200, 2))
    found = weight_uncertainty(columns[:, [0, 0, 1]], 1e-3 * rng.standard_normal((50, 4)))
    np.testing.assert_array_equal(np.isinf(np.diag(found.covariance)), [True, True, False])
    np.testing.assert_array_equal(found.identifiable, [False, False, True])
    assert found.condition > 1e12


def test_large_spread_is_not_identifiable():
    rng = np.random.default_rng(5)
    jacobian = rng.standard_normal((200, 3))
    sharp, blurred = (weight_uncertainty(jacobian, s * rng.standard_normal((50, 4))) for s in (0.1, 10.0))
    assert sharp.identifiable.all()
    assert not blurred.identifiable.any()


def test_one_weight_is_known():
    found = weight_uncertainty(np.ones((5, 1)), np.ones((5, 1)))
    assert found.identifiable.all()
    assert found.covariance == 0.0


@pytest.mark.parametrize(("rho", "factor"), [(0.0, 1.0), (0.5, 3.0), (0.8, 9.0), (-0.5, 1.0)])
def test_inflation_of_autoregressions(rho, factor):
    noise = autoregression(np.random.default_rng(6), rho, (5000, 8))
    assert inflation(noise) == pytest.approx(factor, rel=0.05)


def test_inflation_of_nothing():
    assert inflation(np.zeros((10, 2))) == 1.0
    assert inflation(np.ones((2, 2))) == 1.0


def test_correlation():
    covariance = np.array([[4.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, np.inf]])
    np.testing.assert_allclose(correlation(covariance), [[1.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 0.0]])


def test_fewer_measurements_than_weights_leave_weights_unknown():
    uncertainty = weight_uncertainty(np.array([[1.0, 2.0, 4.0]]), np.array([[0.1]]))
    assert np.isinf(np.diag(uncertainty.covariance)).any()
    assert not uncertainty.identifiable.all()
