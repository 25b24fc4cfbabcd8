r"""Confidence intervals of weights that end at zero, and criteria that the data cannot tell apart.

The profile of one weight is the best fit for each of its values, all others estimated again on the simplex, here of the
linearised lower level:

.. math:: 2 \, (F(\theta_k) - F^*) = \frac{1}{s^2} \min_{\theta \ge 0, \sum \theta = 1, \theta_k}
          \big( |r + J (\theta - \theta^*)|^2 - |r|^2 \big), \qquad s^2 = \kappa |r|^2 / (n_m - n_\theta + 1)

with kappa of `uncertainty`. Its interval ends where it exceeds the quantile of chi^2 with one degree of freedom. A
weight at zero can only be larger: there the quantile is that of the mixture of chi^2_0 and chi^2_1 in equal parts
(Self and Liang 1987, case 5), which leaves the same error on one side.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.optimize import brentq, nnls
from scipy.stats import chi2

from .uncertainty import inflation

CONFIDENCE = 0.95
AT_ZERO = 1e-4
"""Weights below this lie at their bound."""
FIRM = 1e4
"""Weight of the simplex's equality beside the largest entry of the Jacobian."""


@dataclass(frozen=True, kw_only=True)
class WeightInterval:
    """Values of one weight that the data allow."""

    lower: float
    upper: float
    one_sided: bool
    """True where the weight lies at zero: then `lower` is zero and all the error is above."""


@dataclass(frozen=True, kw_only=True)
class LinearisedFit:
    """The fit around an estimate."""

    theta: np.ndarray
    """Estimate on the simplex, shape (n_theta,)."""
    jacobian: np.ndarray
    """J, shape (n_m, n_theta)."""
    residual: np.ndarray
    """r, shape (n_times, n_channels)."""

    @property
    def variance(self) -> float:
        """s^2, in the residual's unit squared."""
        degrees = max(self.residual.size - len(self.theta) + 1, 1)
        return inflation(self.residual) * float(np.sum(self.residual**2)) / degrees

    def excess(self, theta: np.ndarray) -> float:
        """Twice the loss of log-likelihood at theta, shape (n_theta,)."""
        move = self.jacobian @ (theta - self.theta)
        return float(move @ move + 2.0 * self.residual.ravel() @ move) / max(self.variance, np.finfo(float).tiny)

    def profile(self, index: int, value: float) -> float:
        """The same, least over all other weights, where one weight has a value in [0, 1]."""
        others = np.arange(len(self.theta)) != index
        J = self.jacobian[:, others]
        goal = self.jacobian @ self.theta - self.residual.ravel() - self.jacobian[:, index] * value
        anchor = FIRM * max(float(np.abs(J).max(initial=0.0)), np.finfo(float).tiny)
        rest, _ = nnls(np.vstack([J, np.full((1, J.shape[1]), anchor)]), np.append(goal, anchor * (1.0 - value)))
        theta = np.empty_like(self.theta)
        theta[index], theta[others] = value, rest
        return max(self.excess(theta), 0.0)


def weight_interval(fit: LinearisedFit, index: int, confidence: float = CONFIDENCE) -> WeightInterval:
    """Interval of one weight by its profile."""
    now = float(fit.theta[index])
    one_sided = now < AT_ZERO
    limit = float(chi2.ppf(2.0 * confidence - 1.0 if one_sided else confidence, 1))
    if len(fit.theta) == 1:
        return WeightInterval(lower=1.0, upper=1.0, one_sided=False)

    def over(value: float) -> float:
        return fit.profile(index, value) - limit

    lower = 0.0 if one_sided or over(0.0) <= 0.0 else _root(over, 0.0, now)
    upper = 1.0 if over(1.0) <= 0.0 else _root(over, now, 1.0)
    return WeightInterval(lower=lower, upper=upper, one_sided=one_sided)


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    # scipy's own signature says that more than the root may come back.
    return cast("float", brentq(function, low, high, xtol=1e-6))


def not_told_apart(fit: LinearisedFit, confidence: float = CONFIDENCE) -> tuple[tuple[int, int], ...]:
    """Pairs of criteria of which one can take over the other's whole weight without a worse fit than chance.

    Pairs whose weights are both zero are left out: there is nothing to take over.
    """
    limit = float(chi2.ppf(confidence, 1))
    found: list[tuple[int, int]] = []
    for i, j in zip(*np.triu_indices(len(fit.theta), 1), strict=True):
        moves = [(a, b) for a, b in ((i, j), (j, i)) if fit.theta[a] >= AT_ZERO]
        swapped = [fit.theta + fit.theta[a] * (np.eye(len(fit.theta))[b] - np.eye(len(fit.theta))[a]) for a, b in moves]
        if any(fit.excess(theta) <= limit for theta in swapped):
            found.append((int(i), int(j)))
    return tuple(found)


def bootstrap_means(values: np.ndarray, seed: int = 0, confidence: float = CONFIDENCE) -> np.ndarray:
    """Percentile intervals of means, shape (n, 2), from values of several strides, shape (n_strides, n).

    Strides are drawn with replacement (Efron and Tibshirani 1993, ch. 13); 2000 draws.
    """
    draws = np.random.default_rng(seed).integers(0, len(values), size=(2000, len(values)))
    means = values[draws].mean(axis=1)
    tail = 50.0 * (1.0 - confidence)
    return np.percentile(means, [tail, 100.0 - tail], axis=0).T
