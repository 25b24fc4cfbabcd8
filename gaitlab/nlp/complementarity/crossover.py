"""From a nearly complementary point to an exactly complementary, stationary one.

One half of each pair is held at zero; the rest is an ordinary nonlinear program (a branch, or piece, of the problem:
Luo, Pang, Ralph 1996, ch. 6). Where its solution has a biactive pair along which another branch descends, the search
goes on in that branch.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..diagnosis import blame
from ..mpcc import MPCC
from ..mpcc_conditions import MPCCConditions, Stationarity
from ..mpcc_solution import MPCCSolution
from ..outcome import Outcome
from ..problem import NLP, Bounds
from ..solver import NLPSolver
from .method import PathEnd


@dataclass(frozen=True, kw_only=True)
class Tolerances:
    """When a point counts as a solution."""

    violation: float = 1e-6
    complementarity: float = 1e-5
    slope: float = 1e-5
    """Steepest descent that is still called stationary, relative to 1 + |grad f|."""


@dataclass(frozen=True, kw_only=True)
class _Point:
    w: np.ndarray
    """Variables, shape (n_w,)."""
    f: float
    violation: float
    complementarity: float

    def is_feasible(self, tolerances: Tolerances) -> bool:
        within = self.violation <= tolerances.violation
        return within and self.complementarity <= tolerances.complementarity


class Crossover:
    """Branches of one MPCC, and the certificate of their solutions."""

    def __init__(self, problem: MPCC, solver: NLPSolver, tolerances: Tolerances, max_branches: int = 10) -> None:
        self._problem, self._tolerances, self._max_branches = problem, tolerances, max_branches
        self._conditions = MPCCConditions(problem)
        n = 2 * problem.n_pairs
        self._nlp = NLP(
            w=problem.w,
            p=problem.p,
            f=problem.f,
            g=ca.vertcat(problem.g, problem.G, problem.H),
            lbw=problem.lbw,
            ubw=problem.ubw,
            lbg=np.concatenate([problem.lbg, np.zeros(n)]),
            ubg=np.concatenate([problem.ubg, np.full(n, np.inf)]),
        )
        self._solver = solver.prepare(self._nlp)

    def finish(self, end: PathEnd, w: np.ndarray, p: np.ndarray) -> MPCCSolution:
        """Improve the end of a path, w of shape (n_w,) for p of shape (n_p,), and certify it."""
        point, iterations = self._point(w, p), end.iterations
        values = self._conditions.values(w, p)
        held = values.G <= values.H  # (n_c,)
        for _ in range(self._max_branches):
            solution = self._solver.solve(point.w, p, bounds=self._branch(held))
            iterations += solution.iterations
            trial = self._point(solution.w, p)
            if not self._better(trial, point):
                break
            point = trial
            verdict = self._conditions.stationarity(point.w, p, self._tolerances.slope)
            if verdict.stationarity is not Stationarity.DESCENT or np.array_equal(verdict.first_half, held):
                break
            held = verdict.first_half
        return self.certify(point.w, p, end, iterations)

    def certify(self, w: np.ndarray, p: np.ndarray, end: PathEnd, iterations: int) -> MPCCSolution:
        """Certificate of w, shape (n_w,), for p, shape (n_p,), after a path and more iterations."""
        point, stationarity = self._point(w, p), Stationarity.INFEASIBLE
        if point.is_feasible(self._tolerances):
            stationarity = self._conditions.stationarity(w, p, self._tolerances.slope).stationarity
        outcome, reason = self._judge(point, stationarity, p, end)
        return MPCCSolution(
            w=w,
            f=point.f,
            violation=point.violation,
            complementarity=point.complementarity,
            stationarity=stationarity,
            outcome=outcome,
            reason=reason,
            iterations=iterations,
        )

    def _judge(self, point: _Point, stationarity: Stationarity, p: np.ndarray, end: PathEnd) -> tuple[Outcome, str]:
        if stationarity in (Stationarity.STRONG, Stationarity.BOULIGAND):
            return Outcome.SOLVED, stationarity
        if point.is_feasible(self._tolerances):
            outcome = Outcome.STALLED if end.outcome is Outcome.SOLVED else end.outcome
            return outcome, f"{stationarity}; {blame(self._nlp, point.w, p, outcome)}"
        values = self._conditions.values(point.w, p)
        if point.violation <= self._tolerances.violation and values.G.size:
            i = int(np.argmax(np.minimum(np.abs(values.G), np.abs(values.H))))
            reason = f"pair {i} is not complementary: G = {values.G[i]:.3g}, H = {values.H[i]:.3g}"
            return Outcome.STALLED if end.outcome is Outcome.SOLVED else end.outcome, f"{reason} ({end.status})"
        outcome = Outcome.INFEASIBLE if end.outcome is Outcome.SOLVED else end.outcome
        return outcome, f"{blame(self._nlp, point.w, p, outcome)} ({end.status})"

    def _better(self, trial: _Point, point: _Point) -> bool:
        if not np.all(np.isfinite(trial.w)) or not trial.is_feasible(self._tolerances):
            return False
        # An infeasible point often looks cheaper than the solution next to it.
        slack = 1e-3 * (1.0 + abs(point.f)) if point.complementarity > 1e-9 else 1e-9 * (1.0 + abs(point.f))
        return not point.is_feasible(self._tolerances) or trial.f <= point.f + slack

    def _point(self, w: np.ndarray, p: np.ndarray) -> _Point:
        values = self._conditions.values(w, p)
        return _Point(
            w=w,
            f=values.f,
            violation=self._conditions.violation(w, values),
            complementarity=self._conditions.complementarity(values),
        )

    def _branch(self, held_first: np.ndarray) -> Bounds:
        bounds, n_g = self._nlp.bounds, self._problem.g.numel()
        held = np.concatenate([held_first, ~held_first])
        return Bounds(
            lbw=bounds.lbw,
            ubw=bounds.ubw,
            lbg=bounds.lbg,
            ubg=np.concatenate([bounds.ubg[:n_g], np.where(held, 0.0, np.inf)]),
        )
