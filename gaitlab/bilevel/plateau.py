"""A second try for methods that end where the measurements do not tell a parameter.

Where the lower level's active set leaves no freedom its solution does not move with some parameter, and the fit has a
plateau, often beside a better valley. The second search starts at the first one's end, with the parameters that are not
told put back to where they were.
"""

from dataclasses import dataclass, replace

import numpy as np

from .inverse_multi_start import InverseMethod
from .inverse_problem import InverseProblem
from .inverse_result import InverseResult


@dataclass(frozen=True, kw_only=True)
class OffThePlateau:
    """Runs a method, and once more after an end on a plateau."""

    method: InverseMethod

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Better of both ends; w0 has shape (n_w,), p0 (n_p,). Iterations and times are those of both."""
        first = self.method.solve(problem, w0, p0)
        start = put_back(first, problem.start(p0))
        if start is None:
            return first
        second = self.method.solve(problem, w0, start)
        better = second if second.converged and second.objective < first.objective else first
        return replace(
            better,
            iterations=first.iterations + second.iterations,
            lower_iterations=first.lower_iterations + second.lower_iterations,
            seconds=first.seconds + second.seconds,
        )


def put_back(result: InverseResult, p0: np.ndarray) -> np.ndarray | None:
    """The result's parameters, those not told as in p0, shape (n_p,); None where there is nothing to put back."""
    if not result.converged or result.identifiable is None:
        return None
    lost = ~result.identifiable & (result.p != p0)
    return np.where(lost, p0, result.p) if lost.any() else None
