"""Several starts of an estimation: the fit has kinks and plateaus where the lower level's active set changes."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from .inverse_problem import InverseProblem
from .inverse_result import InverseResult


class InverseMethod(Protocol):
    """Settings of a method for inverse problems."""

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from w0, shape (n_w,), and p0, shape (n_p,). Not converging is a result."""
        ...


@dataclass(frozen=True, kw_only=True)
class InverseMultiStart:
    """Runs a method from the given parameters and from random ones around them."""

    method: InverseMethod
    n_starts: int = 5
    spread: float = 0.5
    """Standard deviation of the logarithm of the factors on the parameters."""
    seed: int = 0

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Best converged result over the starts, else the best of all; w0 has shape (n_w,), p0 (n_p,)."""
        random = np.random.default_rng(self.seed)
        factors = np.exp(self.spread * random.standard_normal((self.n_starts, p0.size)))
        factors[0] = 1.0
        results = [self.method.solve(problem, w0, p0 * factor) for factor in factors]
        return min(results, key=lambda result: (not result.converged, result.objective))
