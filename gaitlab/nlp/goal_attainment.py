r"""Minimax problems by goal attainment: sequential quadratic programs with an exact penalty and a trust region.

Each step solves, in the step d, the level :math:`\gamma` and slacks s of the constraints,

.. math::

    \text{minimize} \; \gamma + \nu \, 1^T s + \tfrac{1}{2} d^T H d \quad \text{subject to} \quad
    h_i + \nabla h_i^T d \le \gamma, \; |\phi_j + \nabla \phi_j^T d| \le s_j, \; |d| \le \Delta

with goals of zero and weights of one (Gembicki and Haimes 1975; Zallinger et al. 2025, (31)-(32)), the exact Hessian of
the Lagrangian made positive definite, and a second-order correction (Fletcher, Practical Methods of Optimization,
1987, sec. 14.4). The source uses a quasi-Newton Hessian and reports 100 to 190 iterations.
"""

import time
from dataclasses import dataclass, field

import numpy as np

from ..errors import ProblemError
from .dense_quadratic import DenseQuadratic
from .minimax import (
    MinimaxPoint,
    MinimaxProblem,
    MinimaxSolution,
    MinimaxStatus,
    Multipliers,
    certify,
    estimate_multipliers,
    reduced_curvature,
)

NEAR = 0.05
"""Peaks within this share of the largest may have multipliers in the Hessian."""
ACTIVE = 1e-6
"""Peaks within this share of the largest may have multipliers in the certificate."""
ACCEPTED, GOOD = 0.1, 0.75
"""Ratios of actual to predicted decrease (Nocedal and Wright 2006, Algorithm 4.1)."""
MAX_PENALTY = 1e8
SNAP = 1e-7
"""Relative distance to a bound that counts as touching it."""
SHORTEST = 1e-13
"""Trust region in which nothing can be gained any more."""
BOTTOMLESS = -1e12
"""A value below counts as unbounded."""


@dataclass(frozen=True, kw_only=True)
class GoalAttainment:
    """Settings of the method."""

    tol: float = 1e-6
    """Stationarity relative to the largest entry of a gradient on the way."""
    tol_equality: float = 1e-9
    """Largest violation of a constraint."""
    max_iter: int = 200
    penalty: float = 10.0
    """First weight nu of violated constraints."""
    radius: float = 4.0
    """First trust region, in units of w."""

    def solve(self, problem: MinimaxProblem, w0: np.ndarray) -> MinimaxSolution:
        """Solve from w0, shape (n_w,), which is clipped to the bounds. Not converging is a result.

        Raises:
            ProblemError: w0 has another shape, or an entry that is not a number.
        """
        if w0.shape != problem.lbw.shape or not np.all(np.isfinite(w0)):
            raise ProblemError(f"w0 must be finite with shape {problem.lbw.shape}, got {w0.shape}")
        return _Search(self, problem, np.clip(w0, problem.lbw, problem.ubw)).run()


@dataclass
class _Search:
    method: GoalAttainment
    problem: MinimaxProblem
    w: np.ndarray
    """Best point so far, shape (n_w,)."""
    point: MinimaxPoint = field(init=False)
    penalty: float = field(init=False)
    radius: float = field(init=False)
    scale: float = 0.0
    iterations: int = 0
    evaluations: int = 1
    started: float = field(default_factory=time.perf_counter)

    def __post_init__(self) -> None:
        self.point = self.problem.evaluate(self.w)
        self.penalty, self.radius = self.method.penalty, self.method.radius

    def run(self) -> MinimaxSolution:
        if not np.isfinite(self._merit(self.point)):
            return self._solution(MinimaxStatus.INVALID_NUMBER, "the start itself gives a number that is not finite")
        for iteration in range(self.method.max_iter):
            self.iterations = iteration
            dual = self._dual()
            residuals = certify(self.problem, self.w, self.point, dual)
            self.scale = max(self.scale, float(np.abs(self.point.gradients).max(initial=0.0)))
            if residuals.stationarity <= self.method.tol * self.scale and residuals.primal <= self.method.tol_equality:
                return self._solution(MinimaxStatus.SOLVED, "the first-order conditions hold", dual)
            if self.point.values.max() < BOTTOMLESS:
                return self._solution(MinimaxStatus.UNBOUNDED, f"the largest value fell below {BOTTOMLESS:g}", dual)
            if not self._step():
                return self._stuck()
        self.iterations = self.method.max_iter
        return self._solution(MinimaxStatus.ITERATION_LIMIT, f"{self.method.max_iter} iterations were not enough")

    def _step(self) -> bool:
        """Move to a better point; False where no step does."""
        H = self._convex_hessian()
        while True:
            quadratic = _Subproblem(self, H)
            d, predicted, slack = quadratic.step(self.point.equality)
            inside = np.max(np.abs(d)) < 0.99 * self.radius
            if inside and slack > 1e-12 and self.penalty < MAX_PENALTY:
                self.penalty *= 10.0
                continue
            if predicted <= 1e-15 * (1.0 + abs(self._merit(self.point))):
                return False
            if self._accepts(d, predicted):
                return True
            trial = self.problem.evaluate(self._moved(d))
            shifted = trial.equality - self.point.equality_jacobian @ d
            if np.all(np.isfinite(shifted)) and self._accepts(quadratic.step(shifted)[0], predicted):
                return True
            self.radius = 0.25 * float(np.max(np.abs(d)))
            if self.radius < SHORTEST:
                return False

    def _accepts(self, d: np.ndarray, predicted: float) -> bool:
        w = self._moved(d)
        trial = self.problem.evaluate(w)
        self.evaluations += 1
        ratio = (self._merit(self.point) - self._merit(trial)) / predicted
        if not ratio > ACCEPTED:
            return False
        if ratio > GOOD and np.max(np.abs(d)) > 0.9 * self.radius:
            self.radius *= 2.0
        self.w, self.point = w, trial
        return True

    def _moved(self, d: np.ndarray) -> np.ndarray:
        """Point after a step; the interior point of the subproblem ends a little inside of the bounds."""
        lower, upper, w = self.problem.lbw, self.problem.ubw, self.w + d
        w = np.where(w - lower <= SNAP * (1.0 + np.abs(w)), lower, w)
        return np.where(upper - w <= SNAP * (1.0 + np.abs(w)), upper, w)

    def _merit(self, point: MinimaxPoint) -> float:
        merit = float(point.values.max() + self.penalty * np.abs(point.equality).sum())
        return merit if np.isfinite(merit) else np.inf

    def _convex_hessian(self) -> np.ndarray:
        dual = estimate_multipliers(self.problem, self.w, self.point, NEAR)
        H = self.point.hessian(dual.mu, dual.lam)
        if not np.all(np.isfinite(H)):
            return np.eye(len(H))
        eigenvalues, vectors = np.linalg.eigh(0.5 * (H + H.T))
        floor = 1e-8 * max(float(eigenvalues[-1]), 0.0)
        return (vectors * np.maximum(eigenvalues, floor)) @ vectors.T

    def _dual(self) -> Multipliers:
        return estimate_multipliers(self.problem, self.w, self.point, ACTIVE)

    def _stuck(self) -> MinimaxSolution:
        violation = np.abs(self.point.equality)
        if len(violation) and violation.max() > self.method.tol_equality:
            worst = int(np.argmax(violation))
            reason = f"no step reduces constraint {worst}, violated by {violation[worst]:.2g}"
            return self._solution(MinimaxStatus.INFEASIBLE, reason)
        return self._solution(MinimaxStatus.STALLED, "no step within the trust region lowers the largest value")

    def _solution(self, status: MinimaxStatus, reason: str, dual: Multipliers | None = None) -> MinimaxSolution:
        point = self.point
        if dual is None:
            dual = self._dual() if status is not MinimaxStatus.INVALID_NUMBER else _no_multipliers(point, self.w)
        value = float(point.values.max())
        return MinimaxSolution(
            w=self.w, value=value, objective=value, peaks=point.values[point.is_peak], equality=point.equality,
            multipliers=dual, residuals=certify(self.problem, self.w, point, dual), status=status, reason=reason,
            reduced_curvature=reduced_curvature(point, dual) if status is MinimaxStatus.SOLVED else float("nan"),
            iterations=self.iterations, evaluations=self.evaluations, seconds=time.perf_counter() - self.started,
        )  # fmt: skip


def _no_multipliers(point: MinimaxPoint, w: np.ndarray) -> Multipliers:
    return Multipliers(mu=np.zeros(len(point.values)), lam=np.zeros(len(point.equality)), lam_w=np.zeros(len(w)))


class _Subproblem:
    """Quadratic program of one step in (d, gamma - largest value, s+, s-)."""

    def __init__(self, search: _Search, H: np.ndarray) -> None:
        point, self.n = search.point, len(search.w)
        self.n_phi, self.H, self.search = len(point.equality), H, search
        n, n_phi, n_i = self.n, self.n_phi, len(point.values)
        self.size = n + 1 + 2 * n_phi
        self.levels = np.hstack([point.gradients, -np.ones((n_i, 1)), np.zeros((n_i, 2 * n_phi))])
        identity = np.eye(n_phi)
        self.equalities = np.hstack([point.equality_jacobian, np.zeros((n_phi, 1)), -identity, identity])

    def step(self, equality: np.ndarray) -> tuple[np.ndarray, float, float]:
        """Step d, predicted decrease of the merit function and sum of slacks for the constraint values given."""
        search, n = self.search, self.n
        values, bounds = search.point.values, search.problem
        H = np.zeros((self.size, self.size))
        H[:n, :n] = self.H
        step_rows, slack_rows = np.eye(n, self.size), np.eye(self.size)[n + 1 :]
        solution = DenseQuadratic(
            H=H,
            g=np.concatenate([np.zeros(n), [1.0], np.full(2 * self.n_phi, search.penalty)]),
            E=self.equalities,
            e=-equality,
            C=np.vstack([self.levels, step_rows, -step_rows, -slack_rows]),
            d=np.concatenate(
                [
                    values.max() - values,
                    np.minimum(bounds.ubw - search.w, search.radius),
                    np.minimum(search.w - bounds.lbw, search.radius),
                    np.zeros(2 * self.n_phi),
                ]
            ),
        ).solve()
        d, level, slack = solution.x[:n], float(solution.x[n]), float(np.maximum(solution.x[n + 1 :], 0.0).sum())
        violation = float(np.abs(search.point.equality).sum())
        predicted = search.penalty * (violation - slack) - level - 0.5 * float(d @ self.H @ d)
        return d, predicted, slack
