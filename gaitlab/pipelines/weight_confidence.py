"""Intervals of the weights of one stride, and criteria that it cannot tell apart."""

import numpy as np
from scipy.stats import norm

from ..bilevel.weight_intervals import AT_ZERO, CONFIDENCE, LinearisedFit, not_told_apart, weight_interval
from ..walking.explanation import Explanation


def confidence_intervals(found: Explanation) -> list[list[float] | None]:
    """Interval [lower, upper] of each weight; None where the data do not tell it.

    By the profile of the linearised fit. Where the states between arcs were estimated with the weights, the profile
    would leave out their part: there from the marginal covariance, cut at the simplex's ends, one-sided at zero.
    """
    estimate = found.estimate
    if found.states_estimated:
        return _from_covariance(estimate.theta, estimate.covariance)
    fit = _fit(found)
    intervals = [weight_interval(fit, k) for k in range(len(estimate.theta))]
    return [[interval.lower, interval.upper] for interval in intervals]


def _from_covariance(theta: np.ndarray, covariance: np.ndarray) -> list[list[float] | None]:
    intervals: list[list[float] | None] = []
    for value, variance in zip(theta.tolist(), np.diag(covariance).tolist(), strict=True):
        if not np.isfinite(variance):
            intervals.append(None)
            continue
        tail = CONFIDENCE if value < AT_ZERO else 0.5 * (1.0 + CONFIDENCE)
        reach = float(norm.ppf(tail)) * float(np.sqrt(variance))
        intervals.append([0.0 if value < AT_ZERO else max(0.0, value - reach), min(1.0, value + reach)])
    return intervals


def confused_criteria(found: Explanation) -> list[list[str]]:
    """Pairs of names, see `bilevel.weight_intervals.not_told_apart`."""
    names = found.level.settings.criteria
    return [[names[i], names[j]] for i, j in not_told_apart(_fit(found))]


def _fit(found: Explanation) -> LinearisedFit:
    response = found.estimate.response
    return LinearisedFit(theta=found.estimate.theta, jacobian=response.jacobian(), residual=response.residual_by_time())
