"""Primal-dual interior-point method for problems whose KKT system is block tridiagonal in time.

Line-search filter method of Wächter and Biegler (Math. Program. 106, 2006) with slacks for the inequalities, the
inertia corrected, and one elimination along time per iteration that gives inertia and step. The final
barrier parameter is a setting: a small positive one makes the solution a smooth function of the problem's parameters,
which sensitivities rely on.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .filter_search import LARGEST, Filter, Merit, backtrack
from .kkt_matrix import KKTFactors, kkt_assembly
from .sparse_problem import Derivatives, SparseProblem, Values, multiply, multiply_transposed
from .sparse_solution import SparseSolution, Status, certify

LARGEST_DELTA = 1e8
"""Multiple of the identity beyond which convexifying is given up."""
DEPENDENT = (0.0, 1e-9, 1e-8, 1e-7)
"""Regularisations delta_g tried where the KKT matrix is singular."""

TINY_STEP = 10.0 * float(np.finfo(float).eps)
"""Relative steps below this change nothing."""
TINY_STEPS = 3
"""The method stalls after so many of them in a row."""


class Iterate(NamedTuple):
    """Primal and dual unknowns."""

    w: np.ndarray
    """Variables, shape (n_w,)."""
    s: np.ndarray
    """Slacks of the inequalities, positive, shape (n_c,)."""
    lam_g: np.ndarray
    """Multipliers of g = 0, shape (n_g,)."""
    lam_c: np.ndarray
    """Multipliers of c >= 0, positive, shape (n_c,)."""


class Step(NamedTuple):
    """Newton direction in all unknowns."""

    w: np.ndarray
    """Change of the variables, shape (n_w,)."""
    s: np.ndarray
    """Change of the slacks, shape (n_c,)."""
    lam_g: np.ndarray
    """Change of the multipliers of g = 0, shape (n_g,)."""
    lam_c: np.ndarray
    """Change of the multipliers of c >= 0, shape (n_c,)."""


@dataclass(frozen=True, kw_only=True)
class InteriorPoint:
    """Settings of the method; defaults from Wächter and Biegler (2006) unless said otherwise."""

    tol: float = 1e-8
    """Tolerance on the KKT error of the barrier problem, absolute in the problem's own scaling."""
    mu_initial: float = 1e-2
    mu_final: float = 1e-9
    """Barrier parameter at which the method stops."""
    max_iter: int = 300
    kappa_error: float = 10.0
    """The barrier parameter falls when the KKT error is below this multiple of it."""
    mu_linear: float = 0.2
    mu_power: float = 1.5
    fraction_to_boundary: float = 0.99
    delta_first: float = 1e-4
    """First multiple of the identity tried where the Lagrangian is not convex."""
    gauss_newton: bool = False
    """Where it is not convex, and as long as the barrier parameter is the first, use the problem's Gauss-Newton
    Hessian, if it has one: steps are long far from a solution, and short or circling near one."""

    def solve(
        self,
        problem: SparseProblem,
        start: SparseSolution | np.ndarray,
        progress: Callable[[int, float], None] | None = None,
    ) -> SparseSolution:
        """Solve from a point w, shape (n_w,), or from an earlier solution (warm start with its multipliers).

        `progress(iteration, residual)` may raise `errors.Cancelled`. Not converging is a result: see `status`.
        """
        return _Run(self, problem, progress).solve(start)


class _Run:
    """One solve: the settings, the problem and what changes from iteration to iteration."""

    def __init__(
        self, method: InteriorPoint, problem: SparseProblem, progress: Callable[[int, float], None] | None
    ) -> None:
        self.method, self.problem, self.progress = method, problem, progress
        self.structure = problem.structure
        self.assembly = kkt_assembly(self.structure)
        self.mu = method.mu_initial
        self.delta, self.last_delta, self.delta_g = 0.0, 0.0, 0.0
        self.tiny_steps = 0
        self.filter = Filter()

    def solve(self, start: SparseSolution | np.ndarray) -> SparseSolution:
        """Iterate until converged, stalled or out of iterations."""
        x = self._first(start)
        values = self.problem.values(x.w)
        self.filter = Filter(LARGEST * max(1.0, Merit(values, x.s, self.mu).violation))
        for iteration in range(self.method.max_iter + 1):
            derivatives = self.problem.derivatives(x.w, x.lam_g, x.lam_c)
            if not _finite(values, derivatives):
                return self._end(x, iteration, Status.INVALID_NUMBER)
            self._lower_barrier(x, values, derivatives)
            error = self._error(x, values, derivatives, self.method.mu_final)
            if self.progress is not None:
                self.progress(iteration, error)
            if error <= self.method.tol and self.mu <= self.method.mu_final:
                return self._end(x, iteration, Status.SOLVED)
            moved = self._iterate(x, values, derivatives)
            if moved is None or self._stuck(x, moved[0]):
                return self._end(x, iteration, Status.STALLED)
            x, values = moved
        return self._end(x, self.method.max_iter, Status.ITERATION_LIMIT)

    def _first(self, start: SparseSolution | np.ndarray) -> Iterate:
        if isinstance(start, SparseSolution) and start.mu <= 10.0 * self.mu:
            return Iterate(start.w, start.s, start.lam_g, start.lam_c)
        if isinstance(start, SparseSolution):
            s = np.maximum(start.s, 1e-2 * np.sqrt(self.mu))
            return Iterate(start.w, s, start.lam_g, np.clip(start.lam_c, 0.1 * self.mu / s, 10.0 * self.mu / s))
        s = np.maximum(self.problem.values(start).c, 1e-2)
        return Iterate(start.copy(), s, np.zeros(self.structure.n_g), self.mu / s)

    def _stuck(self, old: Iterate, new: Iterate) -> bool:
        """Whether steps in a row were below rounding in all unknowns (Wächter and Biegler, sec. 3.9)."""
        pairs = zip(old, new, strict=True)
        tiny = all(_norm((after - before) / (1.0 + np.abs(before))) <= TINY_STEP for before, after in pairs)
        self.tiny_steps = self.tiny_steps + 1 if tiny else 0
        return self.tiny_steps == TINY_STEPS

    def _lower_barrier(self, x: Iterate, values: Values, derivatives: Derivatives) -> None:
        method = self.method
        while self.mu > method.mu_final:
            if self._error(x, values, derivatives, self.mu) > method.kappa_error * self.mu:
                return
            self.mu = max(method.mu_final, min(method.mu_linear * self.mu, self.mu**method.mu_power))
            self.filter = Filter(self.filter.largest)

    def _stationarity(self, x: Iterate, derivatives: Derivatives) -> np.ndarray:
        s = self.structure
        return (
            derivatives.grad
            + multiply_transposed(s.jac_g, derivatives.jac_g, x.lam_g, s.n_w)
            - multiply_transposed(s.jac_c, derivatives.jac_c, x.lam_c, s.n_w)
        )

    def _error(self, x: Iterate, values: Values, derivatives: Derivatives, mu: float) -> float:
        n = len(x.lam_g) + len(x.lam_c)
        # Large multipliers make the absolute stationarity meaningless: the scaling of Wächter and Biegler, eq. (5).
        scale = max(100.0, (np.abs(x.lam_g).sum() + x.lam_c.sum()) / max(n, 1)) / 100.0
        return max(
            _norm(self._stationarity(x, derivatives)) / scale,
            _norm(values.g),
            _norm(values.c - x.s),
            _norm(x.s * x.lam_c - mu) / scale,
        )

    def _iterate(self, x: Iterate, values: Values, derivatives: Derivatives) -> tuple[Iterate, Values] | None:
        self.delta = 0.0
        for _ in range(12):
            step = self._direction(x, values, derivatives)
            moved = None if step is None else self._search(x, values, derivatives, step)
            if moved is not None:
                return moved
            self.delta = max(1e-4, 10.0 * max(self.delta, self.last_delta))
            if self.delta >= LARGEST_DELTA:
                break
        return self._restore(x, values, derivatives)

    def _direction(self, x: Iterate, values: Values, derivatives: Derivatives) -> Step | None:
        """Newton direction of a problem made convex on the null space of the constraints, or None."""
        sigma = x.lam_c / x.s
        matrix = self.assembly.matrix((derivatives.hess, derivatives.jac_g, derivatives.jac_c), sigma)
        delta, factors = self.delta, None
        far = self.mu >= self.method.mu_initial
        if self.method.gauss_newton and far and derivatives.gauss_newton is not None:
            factors = self._of_minimum(matrix, delta)
            if factors is None:
                hess = derivatives.gauss_newton()
                matrix = self.assembly.matrix((hess, derivatives.jac_g, derivatives.jac_c), sigma)
        if factors is None:
            delta, factors = self._convexify(matrix)
        for delta_g in DEPENDENT[DEPENDENT.index(self.delta_g) :]:
            if delta_g != self.delta_g or factors is None:
                factors = self.assembly.factorise(self.assembly.shifted(matrix, (delta, delta_g)))
            step = None if factors is None else self._solve_newton(x, values, derivatives, factors)
            if step is not None:
                return step
        return None

    def _of_minimum(self, matrix: np.ndarray, delta: float) -> KKTFactors | None:
        """Factors of the matrix with this regularisation; None where its inertia is not that of a minimum."""
        factors = self.assembly.factorise(self.assembly.shifted(matrix, (delta, self.delta_g)))
        return factors if factors is not None and factors.negative_eigenvalues == self.structure.n_g else None

    def _convexify(self, matrix: np.ndarray) -> tuple[float, KKTFactors | None]:
        """Smallest multiple of the identity, within a factor, that gives the right inertia, and the factors then."""
        delta, factors = self._right_inertia(matrix)
        if delta >= LARGEST_DELTA > self.delta and self.delta_g == 0.0:
            # Dependent equations: no delta_w helps, and from here on the multipliers are regularised instead.
            self.delta_g = DEPENDENT[2]
            delta, factors = self._right_inertia(matrix)
        if delta > self.delta:
            # What only the line search asked for is forgotten: it would grow from iteration to iteration.
            self.last_delta = delta
        return delta, factors

    def _right_inertia(self, matrix: np.ndarray) -> tuple[float, KKTFactors | None]:
        delta = self.delta
        while delta < LARGEST_DELTA:
            factors = self._of_minimum(matrix, delta)
            if factors is not None:
                return delta, factors
            delta = max(self.method.delta_first if self.last_delta == 0.0 else self.last_delta / 3.0, 6.0 * delta)
        return delta, None

    def _solve_newton(self, x: Iterate, values: Values, derivatives: Derivatives, factors: KKTFactors) -> Step | None:
        st = self.structure
        residual_c = values.c - x.s
        pull = self.mu / x.s - x.lam_c - x.lam_c / x.s * residual_c
        top = -self._stationarity(x, derivatives) + multiply_transposed(st.jac_c, derivatives.jac_c, pull, st.n_w)
        solution = factors.solve(np.concatenate([top, -values.g]))
        if solution is None:
            return None
        dw, dlam = solution[: st.n_w], solution[st.n_w :]
        ds = multiply(st.jac_c, derivatives.jac_c, dw, st.n_c) + residual_c
        return Step(dw, ds, dlam, self.mu / x.s - x.lam_c - x.lam_c / x.s * ds)

    def _search(
        self, x: Iterate, values: Values, derivatives: Derivatives, step: Step
    ) -> tuple[Iterate, Values] | None:
        tau = max(self.method.fraction_to_boundary, 1.0 - self.mu)
        alpha_primal, alpha_dual = _largest(x.s, step.s, tau), _largest(x.lam_c, step.lam_c, tau)
        merit = Merit(values, x.s, self.mu)
        slope = float(derivatives.grad @ step.w - self.mu * np.sum(step.s / x.s))

        def trial(alpha: float) -> tuple[np.ndarray, np.ndarray, Values]:
            w, s = x.w + alpha * step.w, x.s + alpha * step.s
            return w, s, self.problem.values(w)

        found = backtrack(self.filter, merit, slope, trial, alpha_primal)
        if found is None:
            return None
        alpha, w, s, new_values = found
        lam_c = x.lam_c + alpha_dual * step.lam_c
        lam_c = np.clip(lam_c, 1e-10 * self.mu / s, 1e10 * self.mu / s)
        return Iterate(w, s, x.lam_g + alpha * step.lam_g, lam_c), new_values

    def _restore(self, x: Iterate, values: Values, derivatives: Derivatives) -> tuple[Iterate, Values] | None:
        """Least-norm steps towards the constraints where the filter blocks every step."""
        before = Merit(values, x.s, self.mu).violation
        if before <= self.method.tol:
            return None
        plain = derivatives._replace(grad=np.zeros_like(x.w), hess=np.zeros_like(derivatives.hess))
        calm = x._replace(lam_g=np.zeros_like(x.lam_g))
        matrix = self.assembly.matrix((plain.hess, plain.jac_g, plain.jac_c), x.lam_c / x.s)
        factors = self.assembly.factorise(self.assembly.shifted(matrix, (1.0, 1e-10)))
        step = None if factors is None else self._solve_newton(calm, values, plain, factors)
        if step is None:
            return None
        alpha = _largest(x.s, step.s, self.method.fraction_to_boundary)
        for _ in range(20):
            w, s = x.w + alpha * step.w, x.s + alpha * step.s
            new = self.problem.values(w)
            if Merit(new, s, self.mu).violation < (1.0 - 1e-2 * alpha) * before:
                self.filter = Filter(self.filter.largest)
                return Iterate(w, s, x.lam_g, np.clip(x.lam_c, 0.1 * self.mu / s, 10.0 * self.mu / s)), new
            alpha /= 2.0
        return None

    def _end(self, x: Iterate, iterations: int, status: Status) -> SparseSolution:
        return certify(self.problem, x, mu=self.mu, iterations=iterations, status=status)


def _largest(value: np.ndarray, step: np.ndarray, tau: float) -> float:
    """Largest alpha <= 1 with value + alpha step >= (1 - tau) value."""
    falling = step < 0.0
    return float(min(1.0, np.min(-tau * value[falling] / step[falling], initial=1.0)))


def _finite(values: Values, derivatives: Derivatives) -> bool:
    arrays = (values.g, values.c, derivatives.grad, derivatives.jac_g, derivatives.jac_c, derivatives.hess)
    return bool(np.isfinite(values.f)) and all(np.all(np.isfinite(a)) for a in arrays)


def _norm(v: np.ndarray) -> float:
    return float(np.max(np.abs(v), initial=0.0))
