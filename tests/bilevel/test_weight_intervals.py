"""Intervals of weights against the covariance inside the simplex, and against coverage at its edge."""

import numpy as np
import pytest

from gaitlab.bilevel.uncertainty import weight_uncertainty
from gaitlab.bilevel.weight_intervals import LinearisedFit, bootstrap_means, not_told_apart, weight_interval

RANDOM = np.random.default_rng(4)
N_TIMES, N_CHANNELS = 200, 2


def fitted(truth, noise=0.1, columns=None, seed=0):
    """Estimate of weights on the simplex of a linear model."""
    random = np.random.default_rng(seed)
    jacobian = RANDOM.normal(size=(N_TIMES * N_CHANNELS, len(truth))) if columns is None else columns
    measured = jacobian @ truth + noise * random.normal(size=len(jacobian))
    start = LinearisedFit(
        theta=truth, jacobian=jacobian, residual=(jacobian @ truth - measured).reshape(N_TIMES, N_CHANNELS)
    )
    theta = simplex_least_squares(jacobian, measured)
    return LinearisedFit(
        theta=theta, jacobian=start.jacobian, residual=(jacobian @ theta - measured).reshape(N_TIMES, N_CHANNELS)
    )


def simplex_least_squares(jacobian, measured):
    """Truth by another way: projected gradient with small steps."""
    theta = np.full(jacobian.shape[1], 1.0 / jacobian.shape[1])
    step = 1.0 / np.linalg.norm(jacobian, 2) ** 2
    for _ in range(3000):
        theta = projected(theta - step * jacobian.T @ (jacobian @ theta - measured))
    return theta


def projected(v):
    ordered = np.sort(v)[::-1]
    total = np.cumsum(ordered) - 1.0
    rho = np.flatnonzero(ordered - total / np.arange(1, len(v) + 1) > 0.0)[-1]
    return np.maximum(v - total[rho] / (rho + 1), 0.0)


def test_inside_the_simplex_it_is_the_gaussian_interval():
    fit = fitted(np.array([0.5, 0.3, 0.2]))
    sd = np.sqrt(np.diag(weight_uncertainty(fit.jacobian, fit.residual).covariance))
    for k in range(3):
        interval = weight_interval(fit, k)
        assert not interval.one_sided
        assert interval.lower == pytest.approx(fit.theta[k] - 1.96 * sd[k], abs=0.01 * sd[k])
        assert interval.upper == pytest.approx(fit.theta[k] + 1.96 * sd[k], abs=0.01 * sd[k])


def test_a_weight_at_zero_has_an_upper_end_only():
    columns = RANDOM.normal(size=(N_TIMES * N_CHANNELS, 3))
    fits = [fitted(np.array([0.6, 0.4, 0.0]), noise=1.0, columns=columns, seed=seed) for seed in range(60)]
    at_zero = [fit for fit in fits if fit.theta[2] < 1e-4]
    intervals = [weight_interval(fit, 2) for fit in at_zero]
    assert 15 <= len(at_zero) <= 45
    assert all(interval.one_sided and interval.lower == 0.0 and 0.0 < interval.upper < 0.3 for interval in intervals)


def test_intervals_cover_a_truth_at_the_edge():
    """The binomial 99.9 % range of 60 draws at 95 %."""
    columns = RANDOM.normal(size=(N_TIMES * N_CHANNELS, 3))
    fits = [fitted(np.array([0.6, 0.4, 0.0]), noise=1.0, columns=columns, seed=seed) for seed in range(60)]
    covered = sum(weight_interval(fit, 0).lower <= 0.6 <= weight_interval(fit, 0).upper for fit in fits)
    assert covered >= 50


def test_twins_are_not_told_apart():
    columns = RANDOM.normal(size=(N_TIMES * N_CHANNELS, 3))
    columns[:, 1] = columns[:, 0] + 0.01 * columns[:, 1]
    fit = fitted(np.array([0.4, 0.3, 0.3]), columns=columns)
    assert not_told_apart(fit) == ((0, 1),)
    assert not_told_apart(fitted(np.array([0.4, 0.3, 0.3]))) == ()


def test_bootstrap_of_means():
    values = RANDOM.normal(0.4, 0.1, size=(40, 2))
    found = bootstrap_means(values)
    expected = values.mean(axis=0)[:, None] + 1.96 * values.std(axis=0)[:, None] / np.sqrt(40) * np.array([-1.0, 1.0])
    assert found == pytest.approx(expected, abs=0.01)
