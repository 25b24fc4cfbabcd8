"""The KKT conditions of a nonlinear program as equations on a guessed active set.

The matrix keeps its pattern whatever is active: a variable held at a bound and the multiplier of a constraint that is
not active get unit equations of their own.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU, splu

from ..nlp.problem import NLP

DUAL_REGULARISATION = 1e-11
"""Makes the matrix regular where active constraints repeat each other; a proximal term, so solutions stay exact."""

SINGULAR = 1e-13
"""An eigenvalue smaller than this, relative to the largest, vanishes."""


@dataclass(frozen=True, kw_only=True)
class PrimalDual:
    """Variables and multipliers, signs as in `NLPSolution`."""

    w: np.ndarray
    """Variables, shape (n_w,)."""
    lam_w: np.ndarray
    """Multipliers of the bounds, shape (n_w,)."""
    lam_g: np.ndarray
    """Multipliers of the constraints, shape (n_g,)."""


@dataclass(frozen=True, kw_only=True)
class LocalModel:
    """Derivatives at a primal-dual point; entries in the order of the sparsities of `KKTPattern`."""

    gradient: np.ndarray
    """df/dw, shape (n_w,)."""
    g: np.ndarray
    """Constraints, shape (n_g,)."""
    jacobian: np.ndarray
    """Entries of dg/dw, shape (n_j,)."""
    hessian: np.ndarray
    """Entries of the upper triangle of the Hessian of the Lagrangian, shape (n_h,)."""


class KKTPattern:
    """Where the entries of Hessian and Jacobian stand in [[H, J'], [J, 0]], all diagonal entries present."""

    def __init__(self, hessian: ca.Sparsity, jacobian: ca.Sparsity) -> None:
        self.n_w, self.n_g = jacobian.size2(), jacobian.size1()
        self.size = self.n_w + self.n_g
        h_rows, h_cols = (np.array(index, dtype=int) for index in hessian.get_triplet())
        j_rows, j_cols = (np.array(index, dtype=int) for index in jacobian.get_triplet())
        self._mirrored = h_rows != h_cols
        every = np.arange(self.size)
        self.rows = np.concatenate([h_rows, h_cols[self._mirrored], j_rows + self.n_w, j_cols, every])
        self.cols = np.concatenate([h_cols, h_rows[self._mirrored], j_cols, j_rows + self.n_w, every])
        places, self._slots = np.unique(self.cols * self.size + self.rows, return_inverse=True)
        self._indices = places % self.size
        self._starts = np.searchsorted(places // self.size, np.arange(self.size + 1))

    def values(self, model: LocalModel) -> np.ndarray:
        """Entries in the order of `rows` and `cols`, the extra diagonal zero, shape (n_entries,)."""
        mirrored, diagonal = model.hessian[self._mirrored], np.zeros(self.size)
        return np.concatenate([model.hessian, mirrored, model.jacobian, model.jacobian, diagonal])

    def matrix(self, values: np.ndarray) -> csc_matrix:
        """Sparse matrix of entries of shape (n_entries,)."""
        data = np.bincount(self._slots, weights=values, minlength=self._indices.size)
        return csc_matrix((data, self._indices, self._starts), shape=(self.size, self.size))


class ActiveSystem:
    """Linear system of one Newton step, with the constraints that multipliers and slacks call active as equations.

    A bound is active where lam + (c - upper) > 0 or lam + (c - lower) < 0: a multiplier larger than its slack.
    """

    def __init__(self, nlp: NLP, pattern: KKTPattern, point: PrimalDual, model: LocalModel) -> None:
        self.point, self._model, self._pattern = point, model, pattern
        held, self._targets_w = _active(point.w, point.lam_w, nlp.lbw, nlp.ubw)
        active, self._targets_g = _active(model.g, point.lam_g, nlp.lbg, nlp.ubg)
        self._unknown = np.concatenate([~held, active])
        self._held, self._active = held, active
        values = pattern.values(model)
        self._full = pattern.matrix(values)
        inside = self._unknown[pattern.rows] & self._unknown[pattern.cols]
        reduced = np.where(inside, values, 0.0)
        unit = np.concatenate([np.where(held, 1.0, 0.0), np.where(active, -DUAL_REGULARISATION, -1.0)])
        reduced[-pattern.size :] += unit
        self._matrix = pattern.matrix(reduced)
        self._factors: SuperLU | None = None

    def newton_point(self) -> PrimalDual | None:
        """Primal-dual point after one Newton step; None where the matrix is singular."""
        x, m, n_w = self.point, self._model, self._pattern.n_w
        known = np.zeros(self._pattern.size)
        known[:n_w][self._held] = self._targets_w[self._held] - x.w[self._held]
        proximal = np.where(self._active, DUAL_REGULARISATION * x.lam_g, 0.0)
        rhs = np.concatenate([-m.gradient, self._targets_g - m.g - proximal]) - self._full @ known
        found = self._solve(np.where(self._unknown, rhs, 0.0)[:, None])
        if found is None:
            return None
        full = found[:, 0] + known
        residual = m.gradient + (self._full @ full)[:n_w]
        return PrimalDual(w=x.w + full[:n_w], lam_w=np.where(self._held, -residual, 0.0), lam_g=full[n_w:])

    def slopes(self, mixed: np.ndarray, jac_p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """dw, dlam_w, dlam_g per parameter from d2L/dw dp, shape (n_w, n_p), and dg/dp, shape (n_g, n_p)."""
        found = self._solve(np.where(self._unknown[:, None], -np.vstack([mixed, jac_p]), 0.0))
        if found is None:
            return None
        n_w = self._pattern.n_w
        residual = mixed + (self._full @ found)[:n_w]
        return found[:n_w], np.where(self._held[:, None], -residual, 0.0), found[n_w:]

    def flat_variable(self) -> int | None:
        """Index of a variable that moves most along a direction without positive curvature; None at a minimum.

        By inertia: at a minimum of full rank the matrix has as many negative eigenvalues as active constraints, and
        none that vanishes.
        """
        unknown = np.flatnonzero(self._unknown)
        dense = self._matrix.toarray()[np.ix_(unknown, unknown)]
        scale = 1.0 / np.sqrt(np.maximum(np.abs(np.diag(dense)), 1e-8))
        values, vectors = np.linalg.eigh(dense * np.outer(scale, scale))
        vanishing = np.abs(values) <= SINGULAR * max(float(np.abs(values).max(initial=0.0)), 1.0)
        n_active = int(self._active.sum())
        if int(np.sum((values < 0.0) & ~vanishing)) == n_active and not vanishing.any():
            return None
        primal = np.abs(vectors * scale[:, None])[unknown < self._pattern.n_w]  # (n_free, n)
        suspects = vanishing if vanishing.any() else values < 0.0
        shares = primal.max(axis=0, initial=0.0) * suspects
        return int(unknown[np.argmax(primal[:, np.argmax(shares)])]) if primal.size else None

    def _solve(self, rhs: np.ndarray) -> np.ndarray | None:
        if not np.all(np.isfinite(rhs)) or not np.all(np.isfinite(self._matrix.data)):
            return None
        try:
            factors: SuperLU = self._factors or splu(self._matrix)
        except RuntimeError:
            return None
        self._factors = factors
        found = factors.solve(rhs)
        miss = float(np.max(np.abs(self._matrix @ found - rhs), initial=0.0))
        size = float(np.max(np.abs(rhs), initial=0.0))
        return found if np.all(np.isfinite(found)) and miss <= 1e-6 * max(size, 1.0) else None


def _active(c: np.ndarray, lam: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which constraints are active, and the values they are held at, zero where they are not."""
    equal = lower == upper
    high = ~equal & np.isfinite(upper) & (lam + (c - upper) > 0.0)
    low = ~equal & np.isfinite(lower) & (lam + (c - lower) < 0.0)
    return equal | high | low, np.where(high, upper, np.where(equal | low, lower, 0.0))
