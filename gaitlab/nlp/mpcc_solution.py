"""Solutions of mathematical programs with complementarity constraints."""

from dataclasses import dataclass

import numpy as np

from .mpcc_conditions import Stationarity
from .outcome import Outcome


@dataclass(frozen=True, kw_only=True)
class MPCCSolution:
    """A point with its certificate, recomputed on the problem as it was posed."""

    w: np.ndarray
    """Variables, shape (n_w,)."""
    f: float
    violation: float
    """Largest violation of bounds, constraints and signs of the pairs."""
    complementarity: float
    """max_i min(|G_i|, |H_i|)."""
    stationarity: Stationarity
    outcome: Outcome
    reason: str
    """One sentence: why it stopped, and which constraint is to blame if it failed."""
    iterations: int
    """Iterations of the solver over all subproblems."""

    def is_feasible(self, tol_violation: float = 1e-6, tol_complementarity: float = 1e-5) -> bool:
        """Check feasibility to absolute tolerances."""
        return self.violation <= tol_violation and self.complementarity <= tol_complementarity

    def is_stationary(self) -> bool:
        """Check that the point is feasible and no direction decreases the objective to first order."""
        return self.stationarity in (Stationarity.STRONG, Stationarity.BOULIGAND)
