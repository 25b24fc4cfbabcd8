"""The upper level as a function of the free parameters alone: every value is a solution of the lower level."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .inverse_finish import Stop, finish, first_response, largest_upper_violation
from .inverse_problem import InverseProblem
from .inverse_result import InverseResult, InverseStatus
from .lower_level import LowerLevel, LowerSettings, Response
from .parameter_set import ParameterSet

Start = tuple[np.ndarray, np.ndarray]


@dataclass
class ReducedObjective:
    """Residuals of the upper level over free parameters, with the best point seen."""

    lower: LowerLevel
    best: Response
    """Lowest objective among solved lower levels so far."""
    penalty: float = 1e3
    """Weight of violated upper-level constraints in the extra residuals."""
    evaluations: int = 0
    failures: int = 0
    last_failure: str = ""
    allowed: ParameterSet = field(init=False)

    def __post_init__(self) -> None:
        self.allowed = ParameterSet(self.lower.problem)

    def respond(self, y: np.ndarray) -> Response | None:
        """Response for free parameters y, shape (n_y,); None where the lower level has no solution."""
        self.evaluations += 1
        response = self.lower.respond(self.allowed.full(y), self.best)
        if not response.solved:
            self.failures += 1
            self.last_failure = self.lower.failure(response)
            return None
        if self.cost(response) < self.cost(self.best):
            self.best = response
        return response

    def residual(self, response: Response) -> np.ndarray:
        """Residuals with those of violated upper-level constraints appended, shape (n_m + n_u,)."""
        problem = self.lower.problem
        miss = np.maximum(np.maximum(problem.lbu - response.upper, response.upper - problem.ubu), 0.0)
        return np.concatenate([response.residual, self.penalty * miss])

    def cost(self, response: Response) -> float:
        """Half the sum of squares of `residual`."""
        r = self.residual(response)
        return 0.5 * float(r @ r)


Search = Callable[[ReducedObjective, float], Stop]
"""Improves the objective's best point; gets `time.perf_counter()` of the start too."""


def search_parameters(problem: InverseProblem, settings: LowerSettings, start: Start, search: Search) -> InverseResult:
    """Estimate by a search over the free parameters from (w0, p0) of shapes (n_w,) and (n_p,).

    Raises:
        ProblemError: p0 has a wrong shape or is not finite.
    """
    began = time.perf_counter()
    lower = LowerLevel(problem, settings)
    response = first_response(lower, *start, began)
    if isinstance(response, InverseResult):
        return response
    objective = ReducedObjective(lower, response)
    return _conclude(objective, search(objective, began), began)


def _conclude(objective: ReducedObjective, stop: Stop, began: float) -> InverseResult:
    """Result of the best point; a claimed convergence is checked against the upper level's constraints."""
    violation, sentence = largest_upper_violation(objective.lower.problem, objective.best.upper)
    if stop.status is InverseStatus.CONVERGED and violation > 1e-4:
        stop = Stop(status=InverseStatus.INFEASIBLE, reason=sentence, iterations=stop.iterations)
    elif stop.status is InverseStatus.CONVERGED:
        flat = objective.lower.not_a_minimum(objective.best)
        if flat is not None:
            stop = Stop(status=InverseStatus.LOWER_LEVEL_FAILED, reason=flat, iterations=stop.iterations)
    elif objective.failures:
        reason = f"{stop.reason}; {objective.failures} points without a solution, last: {objective.last_failure}"
        stop = Stop(status=stop.status, reason=reason, iterations=stop.iterations)
    return finish(objective.lower, objective.best, stop, began)
