r"""Minimax problems through a smooth objective, the p-norm of the functions.

.. math:: J = \Big( \sum_i c_i h_i^\alpha \Big)^{1 / \alpha}

With the quadrature weights of samples over time (`MinimaxPoint.measure`) this is the norm of :math:`L^\alpha`, which
tends to the largest value from below. Zallinger et al. 2025, (35)-(36), after Charalambous and Bandler (1976), sum over
the local maxima instead, :math:`c_i = 1`: that overestimates the largest value and jumps by up to the factor
:math:`2^{1 / \alpha}` whenever a local maximum appears or disappears, which ends the descent early.
"""

import time
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..errors import ProblemError
from .goal_attainment import GoalAttainment
from .minimax import MinimaxPoint, MinimaxProblem, MinimaxSolution


@dataclass(frozen=True, kw_only=True)
class PNorm:
    """Settings of the method."""

    exponents: tuple[float, ...] = (50.0, 200.0, 1000.0)
    """alpha, raised step by step, each from the solution before; the source takes 1000 at once."""
    solver: GoalAttainment = field(default_factory=lambda: GoalAttainment(tol=1e-5))
    """Minimises the one smooth function; its curvature of up to alpha amplifies rounding errors of the gradient."""

    def __post_init__(self) -> None:
        if not self.exponents or min(self.exponents) < 1.0:
            raise ProblemError(f"a p-norm needs exponents of at least 1, got {self.exponents}")

    def solve(self, problem: MinimaxProblem, w0: np.ndarray) -> MinimaxSolution:
        """Solve from w0, shape (n_w,); the multipliers and residuals are those of the last smooth problem.

        Raises:
            ProblemError: w0 has another shape, or an entry that is not a number.
        """
        started, iterations, evaluations, w = time.perf_counter(), 0, 0, w0
        for exponent in self.exponents:
            solution = self.solver.solve(_Smooth(problem=problem, exponent=exponent), w)
            w, iterations, evaluations = (
                solution.w,
                iterations + solution.iterations,
                evaluations + solution.evaluations,
            )
        point = problem.evaluate(w)
        return replace(
            solution,  # pyright: ignore[reportPossiblyUnboundVariable] - there is at least one exponent
            value=float(point.values.max()),
            peaks=point.values[point.is_peak],
            iterations=iterations,
            evaluations=evaluations,
            seconds=time.perf_counter() - started,
        )


@dataclass(frozen=True, kw_only=True)
class _Smooth:
    """A minimax problem of one function."""

    problem: MinimaxProblem
    exponent: float

    @property
    def lbw(self) -> np.ndarray:
        return self.problem.lbw

    @property
    def ubw(self) -> np.ndarray:
        return self.problem.ubw

    def evaluate(self, w: np.ndarray) -> "_SmoothPoint":
        return _SmoothPoint(point=self.problem.evaluate(w), exponent=self.exponent)


@dataclass(frozen=True, kw_only=True, eq=False)
class _SmoothPoint:
    point: MinimaxPoint
    exponent: float
    is_peak: np.ndarray = field(default_factory=lambda: np.array([True]))
    """There is one function, shape (1,)."""
    measure: np.ndarray = field(default_factory=lambda: np.ones(1))
    """There is one function, shape (1,)."""

    @property
    def values(self) -> np.ndarray:
        return np.array([self._norm])

    @property
    def equality(self) -> np.ndarray:
        return self.point.equality

    @property
    def gradients(self) -> np.ndarray:
        return (self._shares @ self.point.gradients)[None]

    @property
    def equality_jacobian(self) -> np.ndarray:
        return self.point.equality_jacobian

    def hessian(self, mu: np.ndarray, lam: np.ndarray) -> np.ndarray:
        result = self.point.hessian(mu[0] * self._shares, lam)
        if self._norm <= 0.0:
            return result
        gradients, total = self.point.gradients, self.gradients[0]
        used = self._shares > 0.0
        spread = (gradients[used].T * (self._shares[used] / self.point.values[used])) @ gradients[used]
        return result + mu[0] * (self.exponent - 1.0) * (spread - np.outer(total, total) / self._norm)

    @cached_property
    def _norm(self) -> float:
        return p_norm(self.point.values, self.point.measure, self.exponent)

    @cached_property
    def _shares(self) -> np.ndarray:
        """dJ/dh_i = c_i (h_i / J)^(alpha - 1), shape (n_i,)."""
        values = self.point.values
        if self._norm <= 0.0:  # Nothing is positive: the subgradient of the largest value.
            chosen = (self.point.measure > 0.0) & (values == self._norm)
            return chosen / max(int(chosen.sum()), 1)
        return self.point.measure * (np.maximum(values, 0.0) / self._norm) ** (self.exponent - 1.0)


def p_norm(values: np.ndarray, weights: np.ndarray, exponent: float) -> float:
    """(sum of c_i h_i^alpha)^(1/alpha) over the positive values, shapes (n,); the largest where there are none."""
    counted = values[weights > 0.0]
    largest = float(counted.max(initial=-np.inf))
    if not largest > 0.0:
        return largest
    ratios = np.maximum(counted, 0.0) / largest
    return largest * float(weights[weights > 0.0] @ ratios**exponent) ** (1.0 / exponent)
