"""Solutions of sparse nonlinear programs, certified independently of the solver."""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

import numpy as np

from .solution import KKTResiduals
from .sparse_problem import SparseProblem, multiply_transposed


class Status(StrEnum):
    """How a solve ended."""

    SOLVED = "solved"
    STALLED = "stalled: no step improves feasibility or the objective"
    ITERATION_LIMIT = "iteration limit reached"
    INVALID_NUMBER = "a function returned a number that is not finite"


class PrimalDual(Protocol):
    """Anything with primal and dual unknowns."""

    @property
    def w(self) -> np.ndarray:
        """Variables, shape (n_w,)."""
        ...

    @property
    def s(self) -> np.ndarray:
        """Slacks, shape (n_c,)."""
        ...

    @property
    def lam_g(self) -> np.ndarray:
        """Multipliers, shape (n_g,)."""
        ...

    @property
    def lam_c(self) -> np.ndarray:
        """Multipliers, shape (n_c,)."""
        ...


@dataclass(frozen=True, kw_only=True)
class SparseSolution:
    """Primal-dual point with its certificate."""

    w: np.ndarray
    """Variables, shape (n_w,)."""
    s: np.ndarray
    """Slacks of the inequalities, shape (n_c,)."""
    lam_g: np.ndarray
    """Multipliers of g = 0 in f + lam_g' g - lam_c' c, shape (n_g,)."""
    lam_c: np.ndarray
    """Multipliers of c >= 0, not negative, shape (n_c,)."""
    f: float
    mu: float
    """Barrier parameter at which the solver stopped."""
    iterations: int
    residuals: KKTResiduals = field(repr=False)
    status: Status

    def is_optimal(self, tol: float) -> bool:
        """Check the first-order conditions to the absolute tolerance `tol`."""
        return self.residuals.max() < tol


def certify(problem: SparseProblem, x: PrimalDual, *, mu: float, iterations: int, status: Status) -> SparseSolution:
    """Recompute the first-order conditions at x.

    stationarity |grad f + J_g' lam_g - J_c' lam_c|, primal max(|g|, max(-c, 0)), complementarity |c_i lam_c,i|, all in
    the infinity norm, with the true constraint values instead of the solver's slacks.
    """
    values = problem.values(x.w)
    derivatives = problem.derivatives(x.w, x.lam_g, x.lam_c)
    structure = problem.structure
    stationarity = (
        derivatives.grad
        + multiply_transposed(structure.jac_g, derivatives.jac_g, x.lam_g, structure.n_w)
        - multiply_transposed(structure.jac_c, derivatives.jac_c, x.lam_c, structure.n_w)
    )
    residuals = KKTResiduals(
        stationarity=_norm(stationarity),
        primal=_norm(np.concatenate([values.g, np.minimum(values.c, 0.0)])),
        complementarity=_norm(values.c * x.lam_c),
    )
    return SparseSolution(
        w=x.w, s=x.s, lam_g=x.lam_g, lam_c=x.lam_c, f=values.f, mu=mu,
        iterations=iterations, residuals=residuals, status=status,
    )  # fmt: skip


def _norm(v: np.ndarray) -> float:
    return float(np.max(np.abs(v), initial=0.0))
