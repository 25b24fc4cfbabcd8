r"""One point of a prediction: the walk for one body and task, with periodicity and the stride time solved for.

Outside the band structure of the walk stand few unknowns y: the multipliers nu of the periodicity and the logarithm of
the stride time, tau = log(T / T_0). For given y the walk is solved by the interior-point method; y itself by Newton's
method on

.. math::

    R(y) = \Big( Z (x_N - x_0) - Z d(\tau), \;\; \partial_\tau L + p_T + w_T \tau \Big) = 0,

whose derivatives are those of the walk's optimality conditions (implicit function theorem). Derivatives in tau of the
problem's functions at a fixed point are central differences.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..errors import NotConverged
from ..nlp.interior_point import InteriorPoint
from ..nlp.sensitivity import Sensitivity
from ..nlp.sparse_solution import SparseSolution, Status
from .prediction_problem import PredictionProblem, lagrangian_gradient
from .situation import Situation
from .what_if import relative_distance

TIME_DIFFERENCE = 1e-4
"""Step of the central differences in the logarithm of the stride time."""


class Outer(NamedTuple):
    """Unknowns outside the band."""

    pull: np.ndarray
    """Multipliers nu of the periodicity, shape (n_periodic,)."""
    log_time: float


class TimeHabit(NamedTuple):
    """What holds the stride time."""

    price: float
    """p_T: what the identified stride time cost."""
    stiffness: float
    """w_T: weight of the squared relative deviation from it."""


class _TimeDerivatives(NamedTuple):
    """How the problem's functions change with tau at a fixed point."""

    lagrangian: float
    curvature: float
    gradient: np.ndarray
    """Of the Lagrangian in w, shape (n_w,)."""
    equalities: np.ndarray
    """Of g, shape (n_g,)."""
    inequalities: np.ndarray
    """Of c, shape (n_c,)."""
    gap: np.ndarray
    """Wanted differences between the ends, shape (n_periodic,)."""
    gap_curvature: np.ndarray
    """Their second derivative, shape (n_periodic,)."""


@dataclass(frozen=True, eq=False)
class PredictedPoint:
    """The walk for one situation and one y; a solution of the prediction where the residual vanishes."""

    family: PredictionProblem
    situation: Situation
    outer: Outer
    solution: SparseSolution
    habit: TimeHabit

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """Factorised optimality conditions of the walk for given y."""
        return Sensitivity(self.family.at(self.situation, self.outer.log_time, self.outer.pull), self.solution)

    @property
    def frees_time(self) -> bool:
        """Whether the stride time is an unknown."""
        return self.situation.task.frees_time

    @cached_property
    def residual(self) -> np.ndarray:
        """R(y), shape (n_periodic,) or, with a free stride time, (n_periodic + 1,)."""
        apart = self.family.ends_apart(self.solution.w) - self.family.gap(self.situation, self.outer.log_time)
        return np.append(apart, self.time_slope) if self.frees_time else apart

    @cached_property
    def time_slope(self) -> float:
        """Derivative of the cost in tau, with what the habit adds."""
        slope = self._time.lagrangian - float(self.outer.pull @ self._time.gap)
        return slope + self.habit.price + self.habit.stiffness * self.outer.log_time

    @cached_property
    def _time(self) -> _TimeDerivatives:
        h, x, family = TIME_DIFFERENCE, self.solution, self.family

        def at(log_time: float) -> np.ndarray:
            """Lagrangian, then g, c and the gap, shape (1 + n_g + n_c + n_periodic,)."""
            values = family.at(self.situation, log_time).values(x.w)
            lagrangian = values.f + float(x.lam_g @ values.g) - float(x.lam_c @ values.c)
            return np.concatenate([[lagrangian], values.g, values.c, family.gap(self.situation, log_time)])

        now, n_g, n_c = self.outer.log_time, len(x.lam_g), len(x.lam_c)
        low, middle, high = (at(now + step) for step in (-h, 0.0, h))
        slopes = [lagrangian_gradient(family.at(self.situation, now + step), x) for step in (-h, h)]
        first, second = (high - low) / (2.0 * h), (low - 2.0 * middle + high) / h**2
        return _TimeDerivatives(
            lagrangian=float(first[0]),
            curvature=float(second[0]),
            gradient=(slopes[1] - slopes[0]) / (2.0 * h),
            equalities=first[1 : 1 + n_g],
            inequalities=first[1 + n_g : 1 + n_g + n_c],
            gap=first[1 + n_g + n_c :],
            gap_curvature=second[1 + n_g + n_c :],
        )

    @cached_property
    def _columns(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Moves of the walk's conditions with y: (n_w, n_y), (n_g, n_y), (n_c, n_y)."""
        mixed = self.family.pull_columns()
        if self.frees_time:
            mixed = np.column_stack([mixed, self._time.gradient])
        n_y, s = mixed.shape[1], self.sensitivity.structure
        equalities, inequalities = np.zeros((s.n_g, n_y)), np.zeros((s.n_c, n_y))
        if self.frees_time:
            equalities[:, -1], inequalities[:, -1] = self._time.equalities, self._time.inequalities
        return mixed, equalities, inequalities

    @cached_property
    def _moves(self) -> np.ndarray:
        """Derivative of (w, lam_g) in y, shape (n_w + n_g, n_y)."""
        return self.sensitivity.of_conditions(*self._columns)

    def _residual_moves(self, moves: np.ndarray, inequalities: np.ndarray) -> np.ndarray:
        """Change of R by moves of (w, lam_g), (n_w + n_g, m), while c moves by (n_c, m): shape (n_y, m)."""
        s = self.sensitivity
        n_w = s.structure.n_w
        ends = self.family.pull_columns().T @ moves[:n_w]
        if not self.frees_time:
            return ends
        t = self._time
        slacks = np.stack([s.slack_moves(column) for column in moves.T], axis=1) + inequalities
        time = t.gradient @ moves[:n_w] + t.equalities @ moves[n_w:] + (t.inequalities * s.sigma) @ slacks
        return np.vstack([ends, time])

    @cached_property
    def jacobian(self) -> np.ndarray:
        """dR/dy, shape (n_y, n_y); symmetric."""
        J = self._residual_moves(self._moves, self._columns[2])
        if self.frees_time:
            J[:-1, -1] -= self._time.gap
            J[-1, :-1] -= self._time.gap
            J[-1, -1] += self._time.curvature - float(self.outer.pull @ self._time.gap_curvature) + self.habit.stiffness
        return J

    def is_minimum(self) -> bool:
        """Second-order sufficiency with periodicity and stride time: the inertia of the whole KKT matrix.

        By Haynsworth's formula it is that of the walk's own matrix and of the Schur complement dR/dy, which must have
        one negative eigenvalue per condition of periodicity.
        """
        eigenvalues = np.linalg.eigvalsh(0.5 * (self.jacobian + self.jacobian.T))
        return self.sensitivity.is_minimum() and int(np.sum(eigenvalues < 0.0)) == len(self.outer.pull)

    def moved(self, situation: Situation) -> tuple[Outer, SparseSolution]:
        """First-order prediction of y and the walk for a neighbouring situation, or for R = 0 in the same one."""
        s, x = self.sensitivity, self.solution
        problem = self.family.at(situation, self.outer.log_time, self.outer.pull)
        values = problem.values(x.w)
        shift = values.c - x.s
        own = s.of_conditions(lagrangian_gradient(problem, x)[:, None], values.g[:, None], shift[:, None])[:, 0]
        there = self if situation is self.situation else replace_point(self, situation)
        wanted = there.residual + self._residual_moves(own[:, None], shift[:, None])[:, 0]
        dy = -np.linalg.solve(self.jacobian, wanted)
        n = len(self.outer.pull)
        log_time = self.outer.log_time + (float(dy[n]) if self.frees_time else 0.0)
        outer = Outer(self.outer.pull + dy[:n], log_time)
        return outer, s.predict(own + self._moves @ dy, shift + self._columns[2] @ dy)


def replace_point(point: PredictedPoint, situation: Situation) -> PredictedPoint:
    """The same unknowns in another situation: no solution there, but what R and the conditions say of them."""
    return PredictedPoint(point.family, situation, point.outer, point.solution, point.habit)


@dataclass(frozen=True, kw_only=True)
class Corrector:
    """Newton's method on y around the interior-point method."""

    solver: InteriorPoint = InteriorPoint(tol=1e-8, mu_initial=1e-7, mu_final=1e-7, max_iter=20)
    tol: float = 1e-7
    """On R."""
    max_iter: int = 8

    def solve(self, point: PredictedPoint, situation: Situation) -> tuple[PredictedPoint, float]:
        """The solution for a neighbouring situation, and its distance from the prediction in predicted moves.

        The solution's iterations are those of all solves together.

        Raises:
            NotConverged: the walk is not solved, or R does not vanish; the message says which.
        """
        before = point.solution.w
        outer, start = point.moved(situation)
        predicted, iterations = start.w, 0
        for _ in range(self.max_iter):
            problem = point.family.at(situation, outer.log_time, outer.pull)
            solution = self.solver.solve(problem, start)
            iterations += solution.iterations
            if solution.status is not Status.SOLVED:
                raise NotConverged(f"the walk is not solved: {solution.status.value}")
            point = PredictedPoint(point.family, situation, outer, solution, point.habit)
            if float(np.max(np.abs(point.residual))) <= self.tol:
                error = relative_distance(solution.w, predicted, relative_distance(predicted, before, 1.0))
                return replace(point, solution=replace(solution, iterations=iterations)), error
            outer, start = point.moved(situation)
        raise NotConverged(
            f"periodicity and stride time are left with a residual of {np.max(np.abs(point.residual)):.1e}"
        )
