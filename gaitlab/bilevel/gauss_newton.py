"""Gauss-Newton on the parameters, with the lower level solved at every step and differentiated at its solution.

Levenberg-Marquardt damping (Nocedal and Wright 2006, sec. 10.3) around the linearised fit; bounds, simplex and
linearised upper-level constraints are kept by a small quadratic program, and an l1 penalty decides on steps where
upper-level constraints are curved.
"""

import time
from dataclasses import dataclass, field, replace

import numpy as np

from .inverse_finish import Stop, finish, first_response, largest_upper_violation, unsolved
from .inverse_problem import InverseProblem
from .inverse_result import InverseResult, InverseStatus
from .lower_level import LowerLevel, LowerSettings, Response, Slopes
from .parameter_set import ParameterSet, Rows
from .plateau import put_back

SHORT_REACH = 0.1
"""Reach of the second search after an end on a plateau."""
SINGULAR = "the KKT matrix of the lower level is singular"


@dataclass(frozen=True, kw_only=True)
class GaussNewton:
    """Settings of the method."""

    lower: LowerSettings = field(default_factory=LowerSettings)
    max_iter: int = 100
    tol_step: float = 1e-8
    """Converged when no parameter moves by more, relative to 1e-3 + |p|."""
    tol_decrease: float = 1e-10
    """Converged when the model of the fit promises less, relatively."""
    damping: float = 1e-4
    """First damping factor, relative to the diagonal of J'J."""
    max_damping: float = 1e8
    reach: float = 1.0
    """Largest first step of a parameter relative to its size; a larger one may jump over a change of the lower
    level's active set onto a plateau where the fit does not depend on it."""
    seconds: float = 600.0
    """Wall time after which the search stops [s]."""

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from a start w0, shape (n_w,), of the lower level and p0, shape (n_p,).

        Raises:
            ProblemError: p0 has a wrong shape or is not finite.
        """
        return self.prepare(problem).solve(w0, p0)

    def prepare(self, problem: InverseProblem) -> "PreparedGaussNewton":
        """Form all derivatives once for many starts."""
        return PreparedGaussNewton(self, problem)


class PreparedGaussNewton:
    """The method bound to one problem."""

    def __init__(self, settings: GaussNewton, problem: InverseProblem) -> None:
        self._settings, self._problem = settings, problem
        self._lower = LowerLevel(problem, settings.lower)

    def solve(self, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from w0, shape (n_w,), and p0, shape (n_p,)."""
        began = time.perf_counter()
        lower = self._lower
        lower.iterations = 0
        response = first_response(lower, w0, p0, began)
        if isinstance(response, InverseResult):
            return response
        search = _Search(self._settings, lower, response, began)
        stop = search.run()
        result = finish(lower, search.response, stop, began)
        return self._off_the_plateau(search.response, result, response.p, began)

    def _off_the_plateau(self, end: Response, result: InverseResult, p0: np.ndarray, began: float) -> InverseResult:
        """Where the fit does not tell a parameter, go back to its first value and come again with shorter steps."""
        p = put_back(result, p0)
        if p is None:
            return result
        response = self._lower.respond(self._problem.start(p), end)
        if not response.solved:
            return result
        careful = replace(self._settings, reach=min(SHORT_REACH, self._settings.reach))
        search = _Search(careful, self._lower, response, began)
        stop = search.run()
        again = finish(
            self._lower, search.response, replace(stop, iterations=stop.iterations + result.iterations), began
        )
        return again if again.converged and again.objective < result.objective else result


@dataclass
class _Search:
    method: GaussNewton
    lower: LowerLevel
    response: Response
    began: float
    damping: float = field(init=False)
    reach: float = field(init=False)
    weight: float = 0.0
    """Penalty of the violation of upper-level constraints."""

    def __post_init__(self) -> None:
        self.damping, self.reach = self.method.damping, self.method.reach
        self.problem = self.lower.problem
        self.allowed = ParameterSet(self.problem)
        self.size = np.maximum(np.abs(self.response.p[self.allowed.index]), 1e-3)

    def run(self) -> Stop:
        for iteration in range(self.method.max_iter):
            slopes = self.lower.slopes(self.response)
            if slopes is None:
                reason = self.lower.not_a_minimum(self.response) or SINGULAR
                return Stop(status=InverseStatus.LOWER_LEVEL_FAILED, reason=reason, iterations=iteration)
            stop = self._step(slopes, iteration + 1)
            if stop is not None:
                return stop
            if time.perf_counter() - self.began > self.method.seconds:
                reason = f"no end within {self.method.seconds:g} s"
                return Stop(status=InverseStatus.TIME_LIMIT, reason=reason, iterations=iteration + 1)
        reason = f"no end within {self.method.max_iter} iterations"
        return Stop(status=InverseStatus.ITERATION_LIMIT, reason=reason, iterations=self.method.max_iter)

    def _step(self, slopes: Slopes, iteration: int) -> Stop | None:
        """Move to better parameters; the reason to stop, or None to go on."""
        y, residual = self.response.p[self.allowed.index], self.response.residual
        J = slopes.residual[:, self.allowed.index]
        hessian, gradient = J.T @ J, J.T @ residual
        rows = self._rows(slopes)
        failed: Response | None = None
        while self.damping <= self.method.max_damping:
            limit = self.reach * np.maximum(np.abs(y), 0.3 * self.size)
            d = self.allowed.step(y, hessian + self.damping * _scale(hessian), gradient, rows, limit)
            if d is None:
                return self._infeasible(iteration)
            promised = -float(gradient @ d + 0.5 * d @ hessian @ d)
            if self._is_small(y, d, promised):
                return self._end(failed, iteration)
            trial = self.lower.respond(self.allowed.full(y + d), self.response, slopes)
            failed = None if trial.solved else trial
            if trial.solved and self._accept(trial, promised):
                self.damping = max(self.damping / 8.0, 1e-12)
                self.reach *= 2.0
                return None
            self.damping, self.reach = self.damping * 8.0, max(0.5 * self.reach, 1e-3)
        return self._end(failed, iteration, stalled=True)

    def _rows(self, slopes: Slopes) -> Rows:
        upper = self.response.upper
        matrix = slopes.upper[:, self.allowed.index]
        return Rows(matrix=matrix, lower=self.problem.lbu - upper, upper=self.problem.ubu - upper)

    def _is_small(self, y: np.ndarray, d: np.ndarray, promised: float) -> bool:
        violation, _ = largest_upper_violation(self.problem, self.response.upper)
        if violation > 1e-8:
            return False
        still = bool(np.all(np.abs(d) <= self.method.tol_step * (1e-3 + np.abs(y))))
        return still or promised <= self.method.tol_decrease * self.response.objective

    def _accept(self, trial: Response, promised: float) -> bool:
        before, _ = largest_upper_violation(self.problem, self.response.upper)
        after, _ = largest_upper_violation(self.problem, trial.upper)
        if before > 0.0:
            # The step removes the linearised violation; the penalty makes that worth what it costs.
            self.weight = max(self.weight, 2.0 * max(-promised, 0.0) / before + 1.0)
        merit = self.response.objective + self.weight * before
        if trial.objective + self.weight * after >= merit:
            return False
        self.response = trial
        return True

    def _infeasible(self, iteration: int) -> Stop:
        _, sentence = largest_upper_violation(self.problem, self.response.upper)
        reason = sentence or "no parameters meet the linearised upper-level constraints, bounds and simplex"
        return Stop(status=InverseStatus.INFEASIBLE, reason=reason, iterations=iteration)

    def _end(self, failed: Response | None, iteration: int, stalled: bool = False) -> Stop:
        if failed is not None:
            return unsolved(self.lower, failed, iteration)
        violation, sentence = largest_upper_violation(self.problem, self.response.upper)
        if violation > 1e-6:
            return Stop(status=InverseStatus.INFEASIBLE, reason=sentence, iterations=iteration)
        if stalled:
            reason = "no step improves the fit although its linearisation promises so"
            return Stop(status=InverseStatus.STALLED, reason=reason, iterations=iteration)
        flat = self.lower.not_a_minimum(self.response)
        if flat is not None:
            return Stop(status=InverseStatus.LOWER_LEVEL_FAILED, reason=flat, iterations=iteration)
        reason = "no step within the bounds improves the fit to first order"
        return Stop(status=InverseStatus.CONVERGED, reason=reason, iterations=iteration)


def _scale(hessian: np.ndarray) -> np.ndarray:
    return np.diag(np.diag(hessian) + 1e-12 * max(float(np.trace(hessian)), 1e-300))
