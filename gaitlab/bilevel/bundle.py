r"""Trust-region bundle method on the parameters (Schramm and Zowe 1992; Hatz 2014, section 7.3, Algorithm 3).

The objective F(y) = |r(w^*(y))|^2 / 2 is smooth between changes of the lower level's active set. Its values and
gradients at earlier points make a cutting-plane model,

.. math::

    \min_{v, d} \; v + \tfrac{1}{2 t} |d|^2 \quad \text{s.t.} \quad v \ge g_i^T d - \beta_i, \; y + d \in Y,

with linearisation errors lifted to :math:`\beta_i = \max(|\alpha_i|, c_0 |y - y_i|^2)` where F is not convex (7.19).
Unlike the thesis's, the set Y of bounds and simplex is part of the quadratic program, and gradients come from the
lower level's KKT system. Parameters are scaled by their size.
"""

import time
from dataclasses import dataclass, field

import numpy as np

from .gauss_newton import SINGULAR
from .inverse_finish import Stop
from .inverse_problem import InverseProblem
from .inverse_result import InverseResult, InverseStatus
from .lower_level import LowerSettings, Response
from .parameter_set import Rows, solve_quadratic
from .reduced_objective import ReducedObjective, search_parameters


@dataclass(frozen=True, kw_only=True)
class Bundle:
    """Settings; the constants are those of Hatz (2014), Table 14.12, with a larger bundle."""

    lower: LowerSettings = field(default_factory=LowerSettings)
    size: int = 15
    """Most cuts kept, J_max."""
    radius: float = 0.2
    """First t, relative to 1 / |grad F|."""
    m_serious: float = 0.1
    """Part of the promised decrease that makes a serious step, m_1."""
    m_null: float = 0.2
    """Part of the promised decrease that makes a null step informative, m_2."""
    m_error: float = 0.9
    """m_3 of (7.22)."""
    shrink: float = 0.3
    """Factor of t, rho."""
    convexity: float = 0.1
    """c_0 of (7.19), relative to 1 + F."""
    tol: float = 1e-6
    """epsilon of (7.21) for the linearisation errors, relative to 1 + F."""
    tol_gradient: float = 1e-4
    """epsilon of (7.21) for the gradient per relative change of the parameters, relative to 1 + F."""
    max_iter: int = 500
    seconds: float = 600.0
    """Wall time after which the search stops [s]."""

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from w0, shape (n_w,), and p0, shape (n_p,).

        Raises:
            ProblemError: p0 has a wrong shape or is not finite.
        """
        return search_parameters(
            problem, self.lower, (w0, p0), lambda objective, began: _Search(self, objective, began).run()
        )


@dataclass(frozen=True, kw_only=True)
class _Cut:
    x: np.ndarray
    """Scaled parameters, shape (n_y,)."""
    f: float
    g: np.ndarray
    """Gradient in scaled parameters, shape (n_y,)."""


class _Search:
    def __init__(self, method: Bundle, objective: ReducedObjective, began: float) -> None:
        self._method, self._objective, self._began = method, objective, began
        y = objective.best.p[objective.allowed.index]
        self._size = np.maximum(np.abs(y), 1e-2)
        self._t = 0.0

    def run(self) -> Stop:
        first = self._cut(self._objective.best)
        if first is None:
            reason = self._objective.lower.not_a_minimum(self._objective.best) or SINGULAR
            return self._stop(InverseStatus.LOWER_LEVEL_FAILED, reason, 0)
        centre, cuts = first, [first]
        self._t = self._method.radius / max(float(np.linalg.norm(first.g)), 1e-12)
        shrinks = 0
        for iteration in range(self._method.max_iter):
            if time.perf_counter() - self._began > self._method.seconds:
                return self._stop(InverseStatus.TIME_LIMIT, f"no end within {self._method.seconds:g} s", iteration)
            errors = np.array([self._error(centre, cut) for cut in cuts])
            step = self._model_step(centre, cuts, errors)
            if step is None:
                return self._stop(InverseStatus.STALLED, "the model has no minimum within the bounds", iteration)
            v, d = step
            if self._is_stationary(centre, v, d):
                return self._stop(InverseStatus.CONVERGED, "the aggregate gradient vanishes", iteration)
            trial = self._evaluate(centre.x + d)
            if trial is None or shrinks > 60:
                self._t *= self._method.shrink
                shrinks += 1
                if shrinks > 60:
                    return self._stop(InverseStatus.STALLED, "no step improves the fit or the model", iteration)
                continue
            if trial.f - centre.f < self._method.m_serious * v:
                centre, shrinks = trial, 0
                self._t /= self._method.shrink
            elif self._is_informative(centre, trial, d, v):
                shrinks = 0
                self._t *= self._method.shrink if trial.f - centre.f > -v else 1.0
            else:
                self._t *= self._method.shrink
                shrinks += 1
            cuts = self._kept(centre, [*cuts, trial])
        return self._stop(InverseStatus.ITERATION_LIMIT, "iteration limit reached", self._method.max_iter)

    def _is_stationary(self, centre: _Cut, v: float, d: np.ndarray) -> bool:
        """Criterion (7.21): aggregate gradient -d / t, and what the model promises beyond it."""
        aggregate, scale = float(np.linalg.norm(d)) / self._t, 1.0 + abs(centre.f)
        error = -v - float(d @ d) / self._t
        return aggregate <= self._method.tol_gradient * scale and error <= self._method.tol * scale

    def _is_informative(self, centre: _Cut, trial: _Cut, d: np.ndarray, v: float) -> bool:
        """Conditions NS(ii) and NS(iii) of (7.22)."""
        error = self._error(centre, trial)
        return error <= self._method.m_error * -v and float(trial.g @ d) - error >= self._method.m_null * v

    def _error(self, centre: _Cut, cut: _Cut) -> float:
        gap = centre.x - cut.x
        error = centre.f - (cut.f + float(cut.g @ gap))
        return max(abs(error), self._method.convexity * (1.0 + abs(centre.f)) * float(gap @ gap))

    def _kept(self, centre: _Cut, cuts: list[_Cut]) -> list[_Cut]:
        if len(cuts) <= self._method.size:
            return cuts
        # The newest cut and that of the centre must stay; the others go by their error.
        others = sorted((c for c in cuts[:-1] if c is not centre), key=lambda cut: self._error(centre, cut))
        chosen = others[: self._method.size - 2] + [centre]
        return [*chosen, cuts[-1]] if cuts[-1] is not centre else chosen

    def _model_step(self, centre: _Cut, cuts: list[_Cut], errors: np.ndarray) -> tuple[float, np.ndarray] | None:
        """V and d of the quadratic program (7.18)."""
        n, allowed = centre.x.size, self._objective.allowed
        slopes = np.array([cut.g for cut in cuts])
        unit = max(float(np.linalg.norm(centre.g)), 1e-12)
        # v is measured in units of the gradient and d in units of t, so that the program is well scaled.
        hessian = np.diag(np.append(1e-9, np.ones(n)))
        weights = self._size * allowed.simplex
        matrix = np.hstack([np.ones((len(cuts), 1)), -slopes / unit])
        rows, lower, upper = [matrix], [-errors / (unit**2 * self._t)], [np.full(len(cuts), np.inf)]
        if allowed.simplex.any():
            rows.append(np.append(0.0, weights / np.linalg.norm(weights))[None, :])
            lower.append(np.zeros(1))
            upper.append(np.zeros(1))
        reach = unit * self._t
        low, high = (allowed.lower / self._size - centre.x) / reach, (allowed.upper / self._size - centre.x) / reach
        found = solve_quadratic(
            hessian,
            np.append(1.0, np.zeros(n)),
            Rows(matrix=np.vstack(rows), lower=np.concatenate(lower), upper=np.concatenate(upper)),
            (np.append(-1e6, np.minimum(low, 0.0)), np.append(1e6, np.maximum(high, 0.0))),
        )
        if found is None:
            return None
        d = np.clip(found[1:], low, high) * reach
        return float(np.max(slopes @ d - errors)), d

    def _evaluate(self, x: np.ndarray) -> _Cut | None:
        response = self._objective.respond(x * self._size)
        return None if response is None else self._cut(response)

    def _cut(self, response: Response) -> _Cut | None:
        slopes = self._objective.lower.slopes(response)
        if slopes is None:
            return None
        problem, index = self._objective.lower.problem, self._objective.allowed.index
        over, under = response.upper - problem.ubu, problem.lbu - response.upper
        miss = np.maximum(over, 0.0) - np.maximum(under, 0.0)
        gradient = slopes.residual.T @ response.residual + self._objective.penalty**2 * slopes.upper.T @ miss
        x = response.p[index] / self._size
        return _Cut(x=x, f=self._objective.cost(response), g=gradient[index] * self._size)

    @staticmethod
    def _stop(status: InverseStatus, reason: str, iterations: int) -> Stop:
        return Stop(status=status, reason=reason, iterations=iterations)
