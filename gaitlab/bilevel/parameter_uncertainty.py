r"""Linearised uncertainty of estimated parameters.

With residuals in units of their standard deviations and the Jacobian J restricted to the directions T that active
bounds, the simplex and active upper-level constraints leave free,

.. math:: C = T (T^T J^T J T)^{-1} T^T

(Bock 1987; Nocedal and Wright 2006, sec. 10.1). A direction along which J T vanishes has infinite variance.
"""

from dataclasses import dataclass

import numpy as np

from .inverse_problem import InverseProblem
from .parameter_set import ParameterSet

WEAKEST = 1e-6
"""A direction whose singular value is smaller, relative to the strongest, carries no information."""


@dataclass(frozen=True, kw_only=True)
class ParameterUncertainty:
    """Second moments of estimated parameters."""

    covariance: np.ndarray
    """Covariance, shape (n_p, n_p): zero for fixed entries and active bounds, infinite where the data do not tell."""
    identifiable: np.ndarray
    """Which entries the data tell, shape (n_p,); True for fixed entries."""
    condition: float
    """Condition number of T'J'JT after scaling by the size of the parameters."""
    blind: np.ndarray
    """Directions in p along which the fit does not change, shape (n_p, n_blind)."""


def parameter_uncertainty(
    problem: InverseProblem, p: np.ndarray, jacobian: np.ndarray, active_upper: np.ndarray
) -> ParameterUncertainty:
    """Uncertainty at p, shape (n_p,), from dr/dp, shape (n_m, n_p), and active rows of du/dp, shape (n_a, n_p)."""
    allowed = ParameterSet(problem)
    free, n_p = allowed.index, problem.n_p
    size = np.maximum(np.abs(p[free]), 1e-3)  # relative changes make parameters of different units comparable
    tangent = _restricted(allowed.tangent(p[free]), active_upper[:, free])
    spread_in = tangent / size[:, None]
    basis, _ = np.linalg.qr(spread_in) if tangent.size else (spread_in, None)
    scaled = basis * size[:, None]  # (n_free, n_t)
    _, strengths, directions = np.linalg.svd(jacobian[:, free] @ scaled, full_matrices=True)
    n_t = scaled.shape[1]
    strengths = np.concatenate([strengths, np.zeros(n_t - strengths.size)])
    weak = strengths <= WEAKEST * max(float(strengths.max(initial=0.0)), np.finfo(float).tiny)
    moves = scaled @ directions.T[:, :n_t]
    known = moves[:, ~weak] / strengths[~weak]
    covariance, identifiable = np.zeros((n_p, n_p)), np.ones(n_p, dtype=bool)
    covariance[np.ix_(free, free)] = known @ known.T
    # A parameter at its bound that does not change the fit has not been pushed there by the data.
    effect = np.linalg.norm(jacobian[:, free], axis=0) * size
    silent = effect <= WEAKEST * max(float(effect.max(initial=0.0)), np.finfo(float).tiny)
    lost = free[np.any(np.abs(moves[:, weak]) > 1e-3 * size[:, None], axis=1) | silent]
    covariance[lost, lost] = np.inf
    identifiable[lost] = False
    blind = np.zeros((n_p, int(weak.sum())))
    blind[free] = moves[:, weak]
    smallest = float(strengths.min(initial=np.inf))
    condition = (float(strengths.max(initial=0.0)) / smallest) ** 2 if smallest > 0.0 else float("inf")
    return ParameterUncertainty(
        covariance=covariance, identifiable=identifiable, condition=condition if n_t else 1.0, blind=blind
    )


def _restricted(tangent: np.ndarray, rows: np.ndarray) -> np.ndarray:
    if not rows.size or not tangent.size:
        return tangent
    _, strengths, directions = np.linalg.svd(rows @ tangent, full_matrices=True)
    rank = int(np.sum(strengths > 1e-10 * max(float(strengths.max(initial=0.0)), 1e-300)))
    return tangent @ directions[rank:].T
