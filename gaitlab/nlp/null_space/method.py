"""The overall framework (Algorithm 4) and its certificate.

Sovukluk and Ott, An Efficient Numerical Function Optimization Framework for Constrained Nonlinear Robotic Problems
(IFAC 2025). Function values only; first order, so many cheap iterations.
"""

import time
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from ...errors import ProblemError
from .descent import reduce_cost
from .feasibility import Feasible, meet_constraints
from .line_search import StepLengths
from .problem import BlackBoxProblem, Evaluations, numerical_gradient, numerical_jacobian
from .projection import allowed_descent

BOTTOMLESS = 1e12
"""Coordinates beyond, or costs below minus this, count as unbounded."""


class BlackBoxStatus(StrEnum):
    """How the optimisation of a black box ended; `BlackBoxSolution.reason` says which constraint is to blame."""

    SOLVED = "solved"
    STALLED = "stalled: no step improves the cost, but the first-order conditions do not hold"
    INFEASIBLE = "a constraint is not met"
    ITERATION_LIMIT = "iteration limit reached"
    UNBOUNDED = "unbounded"
    INVALID_NUMBER = "a function returned a number that is not finite"


@dataclass(frozen=True, kw_only=True)
class BlackBoxSolution:
    """Point with its certificate, from fresh central differences."""

    x: np.ndarray
    """Point, shape (n,)."""
    cost: float
    violation: float
    """Largest violation of a constraint."""
    stationarity: float
    """Largest entry of the steepest descent that the constraints allow."""
    equality_multipliers: np.ndarray
    """Multipliers of the equalities, shape (n_ec,)."""
    inequality_multipliers: np.ndarray
    """Multipliers of the inequalities, not negative, shape (n_ic,)."""
    status: BlackBoxStatus
    reason: str
    """One sentence."""
    iterations: int
    """Outer iterations."""
    evaluations: int
    """Calls of the cost and of the constraint functions."""
    seconds: float

    @property
    def solved(self) -> bool:
        """Whether constraints and first-order conditions hold to the method's tolerances."""
        return self.status is BlackBoxStatus.SOLVED


@dataclass(frozen=True, kw_only=True)
class NullSpaceProjection:
    """Settings of the method; the steps and `step_tol` are those of Table 1."""

    steps: StepLengths = field(default_factory=StepLengths)
    step_tol: float = 1e-4
    """Stop when an outer iteration moves less."""
    cost_tol: float = 1e-6
    """Stop when constraints hold and `patience` iterations together change the cost less, relative to 1 + |cost|."""
    patience: int = 10
    """The source stops after one iteration with a change of 1e-4, which its own example 4.1 makes while infeasible."""
    tol_violation: float = 1e-3
    """Largest violation of a solution."""
    tol_stationarity: float = 1e-2
    """Largest allowed descent of a solution, relative to 1 + the largest entry of the gradient."""
    max_iter: int = 1000

    def solve(self, problem: BlackBoxProblem, x0: np.ndarray) -> BlackBoxSolution:
        """Optimise from x0, shape (n,), which need not be feasible. Not converging is a result.

        Raises:
            ProblemError: x0 is not a vector of finite numbers, or a constraint function has no rows at x0, or rows
                whose number changes.
        """
        if x0.ndim != 1 or not len(x0) or not np.all(np.isfinite(x0)):
            raise ProblemError(f"x0 must be a vector of finite numbers, got shape {x0.shape}")
        return _Run(self, Evaluations(problem, x0), x0.astype(float)).run()


@dataclass
class _Run:
    method: NullSpaceProjection
    evaluations: Evaluations
    x: np.ndarray
    """Point, shape (n,)."""
    iterations: int = 0
    least_violation: float = float("inf")
    last_gain: int = 0
    """Iteration that last brought the constraints nearer."""
    started: float = field(default_factory=time.perf_counter)

    def run(self) -> BlackBoxSolution:
        history: list[float] = []
        for iteration in range(1, self.method.max_iter + 1):
            self.iterations = iteration
            invalid = self._invalid()
            if invalid:
                return self._ended(BlackBoxStatus.INVALID_NUMBER, invalid)
            before = self.x
            self.evaluations.problem.interim(self.x.copy())
            feasible = meet_constraints(self.evaluations, self.x, self.method.steps, self.method.step_tol)
            invalid = self._descend(feasible)
            if invalid:
                return self._ended(BlackBoxStatus.INVALID_NUMBER, invalid)
            history.append(self.evaluations.cost(self.x))
            if history[-1] < -BOTTOMLESS or np.max(np.abs(self.x)) > BOTTOMLESS:
                return self._ended(BlackBoxStatus.UNBOUNDED, "the cost falls along a direction that nothing limits")
            if np.linalg.norm(self.x - before) < self.method.step_tol or self._cost_rests(history) or self._hopeless():
                return self._judged()
        return self._judged(at_limit=True)

    def _descend(self, feasible: Feasible) -> str:
        """Algorithm 3; a sentence where the cost has no gradient."""
        self.x = feasible.x
        gradient = numerical_gradient(self.evaluations.cost, self.x)
        rows = np.vstack([feasible.equality_rows, feasible.inequality_rows])
        if not np.all(np.isfinite(gradient)):
            return "the cost is not a number at or beside the point reached"
        if not np.all(np.isfinite(rows)):
            return "a constraint is not a number beside the point reached"
        self.x = reduce_cost(self.evaluations, feasible, gradient, self.method.steps)
        return ""

    def _cost_rests(self, history: list[float]) -> bool:
        recent = history[-self.method.patience - 1 :]
        if len(recent) <= self.method.patience or self._violation()[0] > self.method.tol_violation:
            return False
        return max(recent) - min(recent) < self.method.cost_tol * (1.0 + abs(recent[-1]))

    def _hopeless(self) -> bool:
        """Whether no constraint has come nearer for twice `patience` iterations."""
        violation = self._violation()[0]
        if violation <= self.method.tol_violation or violation < 0.99 * self.least_violation:
            self.least_violation, self.last_gain = min(violation, self.least_violation), self.iterations
        return self.iterations - self.last_gain >= 2 * self.method.patience

    def _invalid(self) -> str:
        """A sentence where a function has no value."""
        if not np.isfinite(self.evaluations.cost(self.x)):
            return (
                "the cost is not a number at the point reached"
                if self.iterations > 1
                else "the cost is not a number at x0"
            )
        for rows, name in (
            (self.evaluations.equality(self.x), self.evaluations.equality_name),
            (self.evaluations.inequality(self.x), self.evaluations.inequality_name),
        ):
            wrong = np.flatnonzero(~np.isfinite(rows))
            if len(wrong):
                return (
                    f"{name(int(wrong[0]))} is not a number at {'x0' if self.iterations == 1 else 'the point reached'}"
                )
        return ""

    def _violation(self) -> tuple[float, str]:
        """Largest violation and the constraint that has it."""
        equality, excess = np.abs(self.evaluations.equality(self.x)), self.evaluations.inequality(self.x)
        worst_equality, worst_excess = float(np.max(equality, initial=0.0)), float(np.max(excess, initial=0.0))
        if worst_equality >= worst_excess and len(equality):
            return worst_equality, self.evaluations.equality_name(int(np.argmax(equality)))
        return worst_excess, self.evaluations.inequality_name(int(np.argmax(excess))) if len(excess) else ""

    def _judged(self, at_limit: bool = False) -> BlackBoxSolution:
        violation, name = self._violation()
        stationarity, lam, mu, size = self._certificate()
        solved = violation <= self.method.tol_violation and stationarity <= self.method.tol_stationarity * (1.0 + size)
        if solved:
            status, reason = BlackBoxStatus.SOLVED, "constraints and first-order conditions hold"
        elif violation > self.method.tol_violation and not at_limit:
            status, reason = BlackBoxStatus.INFEASIBLE, f"{name} stays violated by {violation:.2g}"
        elif at_limit:
            status, reason = BlackBoxStatus.ITERATION_LIMIT, f"{self.method.max_iter} iterations were not enough"
        else:
            status, reason = (
                BlackBoxStatus.STALLED,
                f"a descent of {stationarity:.2g} per unit is left, no step takes it",
            )
        return self._solution(status, reason, violation, stationarity, (lam, mu))

    def _certificate(self) -> tuple[float, np.ndarray, np.ndarray, float]:
        """Stationarity, multipliers and the largest entry of the gradient."""
        gradient = numerical_gradient(self.evaluations.cost, self.x)
        equality_rows = numerical_jacobian(self.evaluations.equality, self.x)
        rows, values = numerical_jacobian(self.evaluations.inequality, self.x), self.evaluations.inequality(self.x)
        active = values >= -10.0 * self.method.step_tol * np.linalg.norm(rows, axis=1)
        direction, lam, mu = allowed_descent(gradient, equality_rows, rows[active])
        multipliers = np.zeros(len(values))
        multipliers[active] = mu
        return float(np.max(np.abs(direction))), lam, multipliers, float(np.max(np.abs(gradient)))

    def _ended(self, status: BlackBoxStatus, reason: str) -> BlackBoxSolution:
        nothing = np.full(self.evaluations.n_equality, np.nan), np.full(self.evaluations.n_inequality, np.nan)
        return self._solution(status, reason, self._violation()[0], float("nan"), nothing)

    def _solution(
        self,
        status: BlackBoxStatus,
        reason: str,
        violation: float,
        stationarity: float,
        dual: tuple[np.ndarray, np.ndarray],
    ) -> BlackBoxSolution:
        return BlackBoxSolution(
            x=self.x, cost=self.evaluations.cost(self.x), violation=violation, stationarity=stationarity,
            equality_multipliers=dual[0], inequality_multipliers=dual[1], status=status, reason=reason,
            iterations=self.iterations, evaluations=self.evaluations.count, seconds=time.perf_counter() - self.started,
        )  # fmt: skip
