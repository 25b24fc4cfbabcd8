"""The set that estimated parameters must lie in, and quadratic programs over it."""

import casadi as ca
import numpy as np

from .inverse_problem import InverseProblem


class ParameterSet:
    """Free entries y of p with their bounds and the simplex, shape (n_y,)."""

    def __init__(self, problem: InverseProblem) -> None:
        self._problem = problem
        self.index = problem.free_index
        self.lower, self.upper = problem.lbp[self.index], problem.ubp[self.index]
        self.simplex = np.isin(self.index, np.array(problem.simplex, dtype=int))  # (n_y,)

    @property
    def n_y(self) -> int:
        """Number of estimated parameters."""
        return self.index.size

    def full(self, y: np.ndarray) -> np.ndarray:
        """All parameters, shape (n_p,), from the free ones, shape (n_y,)."""
        p = self._problem.p_nominal.copy()
        p[self.index] = y
        return p

    def tangent(self, y: np.ndarray, tol: float = 1e-7) -> np.ndarray:
        """Orthonormal basis of the directions that keep active bounds and the simplex, shape (n_y, n_t)."""
        rows = [np.eye(self.n_y)[(y - self.lower <= tol) | (self.upper - y <= tol)]]
        if self.simplex.any():
            rows.append(self.simplex[None, :].astype(float))
        stacked = np.vstack(rows)
        _, strengths, directions = np.linalg.svd(stacked, full_matrices=True)
        rank = int(np.sum(strengths > 1e-10))
        return directions[rank:].T

    def step(
        self, y: np.ndarray, hessian: np.ndarray, gradient: np.ndarray, rows: "Rows | None", limit: np.ndarray
    ) -> np.ndarray | None:
        """Minimise g'd + d'Hd / 2 with y + d in the set, rows kept and |d| <= limit.

        y, gradient and limit have shape (n_y,), the Hessian (n_y, n_y). None where the rows cannot be met.
        """
        extra = rows or Rows(matrix=np.zeros((0, self.n_y)), lower=np.zeros(0), upper=np.zeros(0))
        n_s = int(self.simplex.any())
        matrix = np.vstack([np.tile(self.simplex.astype(float), (n_s, 1)), extra.matrix])
        lower, upper = np.append(np.zeros(n_s), extra.lower), np.append(np.zeros(n_s), extra.upper)
        bounds = np.maximum(self.lower - y, -limit), np.minimum(self.upper - y, limit)
        d = solve_quadratic(hessian, gradient, Rows(matrix=matrix, lower=lower, upper=upper), bounds)
        return None if d is None else np.clip(d, *bounds)


class Rows:
    """Linear constraints lower <= matrix d <= upper."""

    def __init__(self, *, matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> None:
        self.matrix, self.lower, self.upper = matrix, lower, upper


def solve_quadratic(
    hessian: np.ndarray, gradient: np.ndarray, rows: Rows, bounds: tuple[np.ndarray, np.ndarray]
) -> np.ndarray | None:
    """Minimise g'd + d'Hd / 2 subject to rows and bounds, shapes (n,), (n, n); None where there is no solution."""
    # Unit diagonal: weights and lengths may differ by many orders of magnitude.
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-12 * max(float(np.diag(hessian).max()), 1e-300)))
    matrix = rows.matrix * scale
    sparsity = {"h": ca.Sparsity.dense(*hessian.shape), "a": ca.Sparsity.dense(*matrix.shape)}
    # A dual active-set method (Arnström, Bemporad, Axehill 2022); its defaults are too coarse for last steps.
    options = {"error_on_fail": False, "daqp": {"primal_tol": 1e-10, "dual_tol": 1e-12, "zero_tol": 1e-14}}
    solver = ca.conic("step", "daqp", sparsity, options)
    found = solver(
        h=hessian * np.outer(scale, scale), g=gradient * scale, a=matrix,
        lba=rows.lower, uba=rows.upper, lbx=bounds[0] / scale, ubx=bounds[1] / scale,
    )  # fmt: skip
    d = np.asarray(found["x"]).ravel() * scale
    return d if solver.stats()["success"] and bool(np.all(np.isfinite(d))) else None
