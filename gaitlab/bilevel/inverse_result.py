"""Estimates of inverse problems, with the certificate of their lower level."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from ..nlp.solution import KKTResiduals


class InverseStatus(StrEnum):
    """How an estimation ended; `InverseResult.reason` says which constraint or parameter."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "iteration limit reached"
    TIME_LIMIT = "time limit reached"
    STALLED = "stalled: no step improves the fit"
    LOWER_LEVEL_FAILED = "the lower level is not solved"
    INFEASIBLE = "no feasible point found"
    UNBOUNDED = "unbounded"
    INVALID_NUMBER = "a function returned a number that is not finite"
    CRASHED = "the solver's process ended"


@dataclass(frozen=True, kw_only=True)
class InverseResult:
    """Parameters with the lower-level solution that belongs to them."""

    p: np.ndarray
    """Parameters, shape (n_p,)."""
    w: np.ndarray
    """Lower-level variables, shape (n_w,)."""
    lam_w: np.ndarray
    """Lower-level multipliers of the bounds, shape (n_w,); negative where `lbw` is active."""
    lam_g: np.ndarray
    """Lower-level multipliers of the constraints, shape (n_g,); negative where `lbg` is active."""
    objective: float
    """Half the sum of squared residuals."""
    residuals: KKTResiduals = field(repr=False)
    """Optimality conditions of the lower level at (p, w), recomputed."""
    complementarity: float
    """max_i min(slack_i, |multiplier_i|) of the lower level."""
    status: InverseStatus
    reason: str
    """One sentence: why the method stopped, and what is to blame if it failed."""
    iterations: int
    """Iterations of the upper level."""
    lower_iterations: int
    """Iterations of the lower level's solver in all; zero for methods that have no lower-level solver."""
    seconds: float
    covariance: np.ndarray | None = None
    """Covariance of p, shape (n_p, n_p); zero for fixed entries, infinite where the data do not tell."""
    identifiable: np.ndarray | None = None
    """Which entries of p the data tell, shape (n_p,)."""

    @property
    def converged(self) -> bool:
        """Whether the method reached its own stopping test; `residuals` say what gaitlab verified."""
        return self.status is InverseStatus.CONVERGED

    def is_certified(self, tol: float) -> bool:
        """Check that the method converged and the lower level is optimal to the absolute tolerance `tol`."""
        return self.converged and self.residuals.max() < tol
