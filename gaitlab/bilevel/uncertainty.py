r"""Covariance of weights on the simplex, and which of them the data tell.

Linearised least squares: with the Jacobian J restricted to moves that keep the sum of the weights,
:math:`\theta = \theta^* + T \alpha`,

.. math:: C = s^2 \, T (T^T J^T J T)^{-1} T^T, \qquad s^2 = \kappa \, |r|^2 / (n_m - n_\theta + 1).

Misfit of a model is correlated in time; :math:`\kappa` is the variance inflation (1 + rho) / (1 - rho) of a
first-order autoregression with the residual's own lag-one correlation rho (1 for white noise).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space
from scipy.stats import chi2

LARGEST_SD = 0.15
"""A weight with a larger standard deviation is called not identifiable: two of them span most of [0, 1]."""

SMALLEST_SINGULAR_VALUE = 1e-6
"""Directions of J T weaker than this, relative to the strongest, carry no information."""


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """Second moments of estimated weights."""

    covariance: np.ndarray
    """Covariance, shape (n_theta, n_theta); infinite variance where a direction carries no information."""
    identifiable: np.ndarray
    """One per weight, shape (n_theta,)."""
    condition: float


def weight_uncertainty(jacobian: np.ndarray, residual: np.ndarray) -> Uncertainty:
    """Uncertainty of weights from J, shape (n_m, n_theta), and the residual, shape (n_times, n_channels)."""
    n_theta = jacobian.shape[1]
    tangent = null_space(np.ones((1, n_theta)))  # (n_theta, n_theta - 1)
    if n_theta == 1:
        return Uncertainty(covariance=np.zeros((1, 1)), identifiable=np.ones(1, dtype=bool), condition=1.0)
    # Zero rows keep directions that too few measurements leave blind.
    padded = np.vstack([jacobian @ tangent, np.zeros((n_theta, n_theta - 1))])
    _, strengths, directions = np.linalg.svd(padded, full_matrices=False)
    weak = strengths <= SMALLEST_SINGULAR_VALUE * max(strengths[0], np.finfo(float).tiny)
    degrees = max(residual.size - n_theta + 1, 1)
    variance = inflation(residual) * float(np.sum(residual**2)) / degrees
    spread = tangent @ directions.T  # (n_theta, n_theta - 1)
    known = spread[:, ~weak]
    covariance = variance * (known / strengths[~weak] ** 2) @ known.T
    blind = np.any(np.abs(spread[:, weak]) > 1e-3, axis=1)
    covariance[blind, blind] = np.inf
    identifiable = np.sqrt(np.diag(covariance)) < LARGEST_SD
    condition = float(strengths[0] / strengths[-1]) ** 2 if strengths[-1] > 0.0 else float("inf")
    return Uncertainty(covariance=covariance, identifiable=identifiable, condition=condition)


def ellipsoid_holds(gap: np.ndarray, covariance: np.ndarray, confidence: float = 0.95) -> bool:
    """Whether the confidence ellipsoid around an estimate holds a point a gap away, shape (n_theta,).

    The squared distance in the metric of the covariance, shape (n_theta, n_theta), against the quantile of
    chi-squared. Weights of infinite variance say nothing, and the sum of the weights has no variance: such directions
    do not count.
    """
    known = np.isfinite(np.diag(covariance))
    values, vectors = np.linalg.eigh(covariance[np.ix_(known, known)])
    told = values > 1e-12 * values[-1]
    distance = float(np.sum((vectors[:, told].T @ gap[known]) ** 2 / values[told]))
    return distance <= float(chi2.ppf(confidence, int(told.sum())))


def inflation(residual: np.ndarray) -> float:
    """Variance inflation by lag-one correlation in time of the residual, shape (n_times, n_channels); at least 1."""
    if len(residual) < 3:
        return 1.0
    power = float(np.sum(residual**2))
    rho = float(np.sum(residual[1:] * residual[:-1])) / power if power > 0.0 else 0.0
    rho = min(max(rho, 0.0), 0.99)
    return (1.0 + rho) / (1.0 - rho)


def correlation(covariance: np.ndarray) -> np.ndarray:
    """Correlation matrix of a covariance, shape (n, n); zero where a variance is zero or infinite."""
    sd = np.sqrt(np.diag(covariance))
    usable = np.isfinite(sd) & (sd > 0.0)
    inverse = np.where(usable, 1.0 / np.where(usable, sd, 1.0), 0.0)
    finite = np.where(np.isfinite(covariance), covariance, 0.0)
    return inverse[:, None] * finite * inverse
