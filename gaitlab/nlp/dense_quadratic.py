r"""Small dense convex quadratic programs by a primal-dual interior-point method.

.. math::

    \underset{x}{\text{minimize}} \; \tfrac{1}{2} x^T H x + g^T x \quad \text{subject to} \quad
    E x = e, \; C x \le d

Mehrotra's predictor and corrector (Nocedal and Wright 2006, Algorithm 16.4). The solvers of the CasADi wheel were
tried first: qpOASES prints a banner for every new size, DAQP fails on the singular H of minimax problems.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

MAX_ITER = 60
DIVERGED = 1e15
"""Residual beyond which the iteration is given up."""
ACCEPTED = 1e-7
"""Residual of a point that still counts as solved."""
TO_BOUNDARY = 0.995
"""Share of the way to the boundary of the positive orthant (Nocedal and Wright 2006, sec. 16.6)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DenseQuadratic:
    """Data of a convex quadratic program."""

    H: np.ndarray
    """Positive semidefinite Hessian, shape (n, n)."""
    g: np.ndarray
    """Gradient, shape (n,)."""
    E: np.ndarray
    """Rows of the equalities, shape (n_e, n)."""
    e: np.ndarray
    """Their right-hand sides, shape (n_e,)."""
    C: np.ndarray
    """Rows of the inequalities, shape (n_c, n)."""
    d: np.ndarray
    """Their right-hand sides, shape (n_c,)."""

    def solve(self, tol: float = 1e-10) -> "QuadraticSolution":
        """Solve to the relative tolerance `tol`; whether it was reached is in the solution."""
        return _Iteration(self).run(tol)


@dataclass(frozen=True, kw_only=True, eq=False)
class QuadraticSolution:
    """Primal-dual point of a quadratic program."""

    x: np.ndarray
    """Variables, shape (n,)."""
    lam_e: np.ndarray
    """Multipliers of the equalities in f + lam_e' (E x - e), shape (n_e,)."""
    lam_c: np.ndarray
    """Multipliers of the inequalities, not negative, shape (n_c,)."""
    residual: float
    """Largest violation of the optimality conditions, relative to the data."""
    solved: bool


class _Iteration:
    """State of the interior-point iteration: x, y (equalities), slacks s and multipliers z of the inequalities."""

    def __init__(self, qp: DenseQuadratic) -> None:
        self.qp = qp
        self.x, self.y = np.zeros(len(qp.g)), np.zeros(len(qp.e))
        self.s = np.maximum(qp.d, 1.0)
        self.z = np.ones(len(qp.d))
        self.scales = tuple(1.0 + float(np.max(np.abs(v), initial=0.0)) for v in (qp.g, qp.e, qp.d))

    def run(self, tol: float) -> QuadraticSolution:
        self.start()
        best = self._solution()
        for _ in range(MAX_ITER):
            current = self._solution()
            if not current.residual < DIVERGED:  # Infeasible or unbounded, or not a number.
                break
            if current.residual < best.residual:
                best = current
            if best.residual <= tol or not self._advance():
                break
        return replace(best, solved=best.residual <= ACCEPTED)

    def _residuals(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        qp = self.qp
        stationarity = qp.H @ self.x + qp.g + qp.E.T @ self.y + qp.C.T @ self.z
        return stationarity, qp.E @ self.x - qp.e, qp.C @ self.x + self.s - qp.d

    def _solution(self) -> QuadraticSolution:
        return self._judged(self.x.copy(), self.y.copy(), self.z.copy())

    def _judged(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> QuadraticSolution:
        """Point with the violation of its optimality conditions, the slacks being what the constraints leave."""
        qp = self.qp
        slacks = qp.d - qp.C @ x
        stationarity = qp.H @ x + qp.g + qp.E.T @ y + qp.C.T @ z
        parts = (stationarity, qp.E @ x - qp.e, np.minimum(slacks, 0.0), np.minimum(z, 0.0), slacks * z)
        scales = (*self.scales, 1.0, 1.0)
        residual = max(float(np.max(np.abs(r), initial=0.0)) / scale for r, scale in zip(parts, scales, strict=True))
        return QuadraticSolution(x=x, lam_e=y, lam_c=z, residual=residual, solved=False)

    def start(self) -> None:
        """Move slacks and multipliers to the size that the first affine step asks for (Nocedal and Wright, p. 484)."""
        direction = self._directions()
        if direction is not None:
            _, _, ds, dz = direction(self.s * self.z)
            self.s, self.z = np.maximum(1.0, np.abs(self.s + ds)), np.maximum(1.0, np.abs(self.z + dz))

    def _directions(self) -> Callable[[np.ndarray], tuple[np.ndarray, ...]] | None:
        """Newton directions (dx, dy, ds, dz) for given complementarity residuals; None where the matrix is singular."""
        qp, residuals = self.qp, self._residuals()
        K = qp.H + (qp.C.T * (self.z / self.s)) @ qp.C
        K[np.diag_indices_from(K)] *= 1.0 + 1e-14
        factor, failed = dpotrf(K)
        if failed or not np.all(np.isfinite(factor)):
            return None
        spread = dpotrs(factor, qp.E.T)[0]
        schur, failed = dpotrf(qp.E @ spread + 1e-14 * np.eye(len(qp.e))) if len(qp.e) else (None, 0)
        if failed:
            return None

        def direction(complementarity: np.ndarray) -> tuple[np.ndarray, ...]:
            rhs = -residuals[0] - qp.C.T @ ((self.z * residuals[2] - complementarity) / self.s)
            dx, dy = dpotrs(factor, rhs)[0], np.zeros(len(qp.e))
            if schur is not None:
                dy = dpotrs(schur, qp.E @ dx + residuals[1])[0]
                dx = dx - spread @ dy
            ds = -residuals[2] - qp.C @ dx
            return dx, dy, ds, -(complementarity + self.z * ds) / self.s

        return direction

    def _advance(self) -> bool:
        """One predictor and corrector step; False where the linear system is singular."""
        direction = self._directions()
        if direction is None:
            return False
        gap = float(self.s @ self.z) / max(len(self.s), 1)
        _, _, ds, dz = direction(self.s * self.z)
        affine = float((self.s + _longest(self.s, ds) * ds) @ (self.z + _longest(self.z, dz) * dz)) / max(len(ds), 1)
        centring = (affine / gap) ** 3 if gap > 0.0 else 0.0
        dx, dy, ds, dz = direction(self.s * self.z + ds * dz - centring * gap)
        step = TO_BOUNDARY * min(_longest(self.s, ds), _longest(self.z, dz))
        self.x, self.s = self.x + step * dx, self.s + step * ds
        self.y, self.z = self.y + step * dy, self.z + step * dz
        return True


def _longest(v: np.ndarray, dv: np.ndarray) -> float:
    """Longest step that keeps v >= 0, at most a little more than one."""
    falling = dv < 0.0
    return float(min(1.0 / TO_BOUNDARY, np.min(-v[falling] / dv[falling], initial=np.inf)))
