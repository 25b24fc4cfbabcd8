r"""Profile likelihood: the best fit as a function of one parameter, all others estimated again.

With residuals in units of their standard deviations, minus the log-likelihood is F, and the interval of confidence
:math:`1 - \alpha` is where :math:`2 (F(p_i) - F^*) \le \chi^2_{1, 1 - \alpha}` (Venzon and Moolgavkar 1988; Raue et al.
2009). Unlike the covariance it sees bounds, plateaus and kinks: an end that is not found before a bound or the end of
the search is open, and the parameter is not identifiable on that side.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import chi2

from ..errors import ProblemError
from .gauss_newton import GaussNewton
from .inverse_multi_start import InverseMethod
from .inverse_problem import InverseProblem
from .inverse_result import InverseResult


@dataclass(frozen=True, kw_only=True)
class Profile:
    """Profile of one parameter."""

    values: np.ndarray
    """Values of the parameter in increasing order, shape (n,)."""
    objective: np.ndarray
    """Best fit at each, shape (n,)."""
    lower: float
    """Lower end of the confidence interval; minus infinity where the data do not bound it."""
    upper: float
    """Upper end of the confidence interval; infinity where the data do not bound it."""
    reason: str
    """Empty, or which refit failed and why."""

    @property
    def identifiable(self) -> bool:
        """Whether the interval is bounded by the data on both sides."""
        return bool(np.isfinite(self.lower) and np.isfinite(self.upper))


@dataclass(frozen=True, kw_only=True)
class ProfileLikelihood:
    """Walks from the estimate to both sides with growing steps."""

    method: InverseMethod = field(default_factory=GaussNewton)
    confidence: float = 0.95
    first_step: float = 0.05
    """Relative to max(|p_i|, 1e-3), where the covariance gives no better one."""
    growth: float = 1.5
    max_steps: int = 15

    def run(self, problem: InverseProblem, estimate: InverseResult, index: int) -> Profile:
        """Profile of p[index] around an estimate of `problem`.

        Raises:
            ProblemError: p[index] is not estimated.
        """
        if not 0 <= index < problem.n_p or not problem.free[index]:
            raise ProblemError(f"p[{index}] is not among the estimated parameters {problem.free_index.tolist()}")
        limit = estimate.objective + 0.5 * float(chi2.ppf(self.confidence, 1))
        points = {float(estimate.p[index]): estimate.objective}
        ends: list[float] = []
        reasons: list[str] = []
        for sign in (-1.0, 1.0):
            end, reason = self._walk(problem, (estimate, index, sign), limit, points)
            ends.append(end)
            reasons.append(reason)
        values = np.array(sorted(points))
        return Profile(
            values=values,
            objective=np.array([points[value] for value in values]),
            lower=ends[0],
            upper=ends[1],
            reason="; ".join(reason for reason in reasons if reason),
        )

    def _walk(
        self,
        problem: InverseProblem,
        where: tuple[InverseResult, int, float],
        limit: float,
        points: dict[float, float],
    ) -> tuple[float, str]:
        """End of the interval on one side, and what went wrong."""
        result, index, sign = where
        bound = problem.ubp[index] if sign > 0.0 else problem.lbp[index]
        step = self._first_step(result, index)
        value, before = float(result.p[index]), result
        for _ in range(self.max_steps):
            last_value, last_objective = value, before.objective
            value = min(value + step, bound) if sign > 0.0 else max(value - step, bound)
            if value == last_value:
                break
            refit = self._refit(problem, before, index, value)
            if not refit.converged:
                return sign * np.inf, f"{problem.parameter_name(index)} = {value:.4g}: {refit.reason}"
            points[value] = refit.objective
            if refit.objective > limit:
                # The excess grows quadratically, so its root is interpolated.
                excess = np.array([last_objective, limit, refit.objective]) - result.objective
                low, middle, high = np.sqrt(np.maximum(excess, 0.0))
                return last_value + (value - last_value) * float((middle - low) / (high - low)), ""
            before, step = refit, step * self.growth
        return sign * np.inf, ""

    def _first_step(self, result: InverseResult, index: int) -> float:
        variance = 0.0 if result.covariance is None else float(result.covariance[index, index])
        usual = self.first_step * max(abs(float(result.p[index])), 1e-3)
        return 0.5 * float(np.sqrt(variance)) if 0.0 < variance < np.inf else usual

    def _refit(self, problem: InverseProblem, near: InverseResult, index: int, value: float) -> InverseResult:
        free, nominal = problem.free.copy(), near.p.copy()
        free[index], nominal[index] = False, value
        if not free.any():
            free[index] = True
            lbp, ubp = problem.lbp.copy(), problem.ubp.copy()
            lbp[index] = ubp[index] = value
            return self.method.solve(replace(problem, lbp=lbp, ubp=ubp), near.w, nominal)
        return self.method.solve(replace(problem, free=free, p_nominal=nominal), near.w, nominal)
