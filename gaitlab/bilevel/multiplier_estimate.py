"""Multipliers of a point that is already a solution, or almost: the least squares of stationarity.

A start that someone else has solved needs no interior-point method, which would first leave its active bounds.
"""

import numpy as np
from scipy.sparse import block_array, csr_matrix, identity
from scipy.sparse.linalg import splu

from ..nlp.problem import NLP
from .active_system import PrimalDual

NEAR = 1e-6
"""A constraint nearer to its bound than this is counted as active, relative to 1 + its size."""
REGULARISATION = 1e-10
"""Of the least squares, where active constraints repeat each other."""


def estimate_multipliers(
    nlp: NLP, w: np.ndarray, gradient: np.ndarray, g: np.ndarray, jacobian: csr_matrix
) -> PrimalDual | None:
    """Minimise |grad f + J' lam_g + lam_w| over the multipliers of active constraints.

    At w and grad f of shape (n_w,), g of shape (n_g,) and its Jacobian, shape (n_g, n_w). None where g is infeasible or
    something is not finite.
    """
    if not all(np.all(np.isfinite(part)) for part in (w, gradient, g, jacobian.data)):
        return None
    if np.any(_miss(g, nlp.lbg, nlp.ubg) > 1e-3 * (1.0 + np.abs(g))):
        return None
    held, active = ~_inside(w, nlp.lbw, nlp.ubw), np.flatnonzero(~_inside(g, nlp.lbg, nlp.ubg))
    free = np.flatnonzero(~held)
    lam_w, lam_g = np.zeros(w.size), np.zeros(g.size)
    if active.size and free.size:
        J = csr_matrix(jacobian[active][:, free])
        matrix = block_array([[identity(free.size), J.T], [J, -REGULARISATION * identity(active.size)]], format="csc")
        found = splu(matrix).solve(np.concatenate([-gradient[free], np.zeros(active.size)]))
        lam_g[active] = found[free.size :]
    lam_w[held] = -(gradient + jacobian.T @ lam_g)[held]
    return PrimalDual(w=np.clip(w, nlp.lbw, nlp.ubw), lam_w=lam_w, lam_g=lam_g)


def _miss(c: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    return np.maximum(np.maximum(lower - c, c - upper), 0.0)


def _inside(c: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    near = NEAR * (1.0 + np.abs(c))
    return (c - lower > near) & (upper - c > near)
