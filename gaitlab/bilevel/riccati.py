"""Second-order sufficient conditions by a Riccati equation (Maurer and Oberle 2002; Hatz 2014, (6.27)-(6.30)).

A solution of the maximum principle is a strict local minimum if a symmetric matrix [[Q, R], [R', q_T]] stays bounded
along it and satisfies sign conditions at the ends. On arcs inside the control's bounds it obeys the strong equations
(6.28), on boundary arcs the reduced ones (6.30), whose quadratic terms vanish because the control cannot vary.

Reading: (6.28) and (6.29) belong to a Hamiltonian that is minimised, whereas that of chapter 6 is maximised; with the
printed signs the solutions of all three settings of Table 6.1 blow up. The matrices of Table 6.3 are not reproduced.
"""

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from ..errors import ProblemError
from ..ocp.trajectory import Trajectory
from .indirect import Arc, Hamiltonian

TOLERANCE = 1e-11
AT_FIXED, AT_FREE = (0.1, 1.0, 10.0, 100.0), 1e-3
"""Section 6.2 chooses 0.1 for all; with 0.1 for free ends Settings 2 and 3 of Table 6.1 miss q_T(0) > 0."""


@dataclass(frozen=True, kw_only=True)
class RiccatiTest:
    """Outcome of the test."""

    start: np.ndarray
    """[[Q, R], [R', q_T]] at the start, shape (n_x + 1, n_x + 1)."""
    end: np.ndarray
    """The same at the end, as chosen, shape (n_x + 1, n_x + 1)."""
    largest: float
    """Largest entry along the solution."""
    bounded: bool
    signs: bool
    """Whether the sign condition at the start holds, q_T > 0 (6.29); those at the end hold by choice."""
    legendre: bool
    """Whether H_uu < 0 on all arcs inside (strict Legendre-Clebsch condition)."""
    reason: str

    @property
    def sufficient(self) -> bool:
        """Whether second-order sufficiency is proven. False means: not by this choice at the end."""
        return self.bounded and self.signs and self.legendre


def riccati_test(
    principle: Hamiltonian, solution: Trajectory, parameters: np.ndarray, arcs: tuple[Arc, ...]
) -> RiccatiTest:
    """Integrate the Riccati equations from the end to the start of a solution of the boundary value problem.

    `parameters` are (theta, p), shape (n_p,). The matrix at the end is diagonal: for states that are fixed there, any
    number will do, and those of `AT_FIXED` are tried; for the others and the duration it must be negative: -`AT_FREE`.

    Raises:
        ProblemError: The solution has not as many stages as there are arcs.
    """
    if len(solution.stages) != len(arcs):
        raise ProblemError(f"{len(arcs)} arcs need a solution of as many stages, got {len(solution.stages)}")
    tests = list[RiccatiTest]()
    for fixed in AT_FIXED:
        end = np.diag(np.where(_free(principle), -AT_FREE, fixed))
        tests.append(_integrate(principle, solution, (parameters, end), arcs))
        if tests[-1].sufficient:
            return tests[-1]
    return next((test for test in tests if test.bounded), tests[0])


def _integrate(
    principle: Hamiltonian, solution: Trajectory, choice: tuple[np.ndarray, np.ndarray], arcs: tuple[Arc, ...]
) -> RiccatiTest:
    (parameters, end), n_x = choice, principle.stage.n_x
    total, largest, legendre = float(solution.q.sum()), 0.0, True
    y = np.concatenate([solution.stages[-1].x[-1], end[np.tril_indices(n_x + 1)]])
    for arc, stage in zip(arcs[::-1], solution.stages[::-1], strict=True):
        rate, curvature = _equations(principle, arc, total)
        # Transformed time runs from 0 to 1 over the whole motion.
        path = solve_ivp(
            _rate_of(rate, parameters),
            (stage.duration / total, 0.0), y, method="DOP853", rtol=TOLERANCE, atol=TOLERANCE,
        )  # fmt: skip
        entries = path.y[2 * n_x :]
        largest = max(largest, float(np.max(np.abs(entries))))
        if not path.success or not np.isfinite(largest) or largest > 1e8:
            return _unbounded(end, largest, arc)
        legendre &= arc is not Arc.INSIDE or _is_negative(curvature, path.y, parameters)
        y = path.y[:, -1]
    start = _symmetric(y[2 * n_x :], n_x + 1)
    return _judge(start, end, largest, legendre)


def _rate_of(rate: ca.Function, parameters: np.ndarray) -> Callable[[float, np.ndarray], np.ndarray]:
    def evaluate(time: float, state: np.ndarray) -> np.ndarray:
        del time  # Unused.
        return np.asarray(rate(state, parameters)).ravel()

    return evaluate


def _free(principle: Hamiltonian) -> np.ndarray:
    """Which of the end state and the duration may vary, shape (n_x + 1,)."""
    end = principle.stage.end
    states = ~end.fixed if end is not None else np.ones(principle.stage.n_x, dtype=bool)
    return np.append(states, True)


def _equations(principle: Hamiltonian, arc: Arc, duration: float) -> tuple[ca.Function, ca.Function]:
    """Rates of (x, lam, lower triangle of the matrix) by transformed time, and H_uu."""
    # The conditions are those of a minimised Hamiltonian.
    stage, H, lam = principle.stage, -principle.value, principle.lam
    x, u, n = stage.x, stage.u, stage.n_x
    entries = ca.SX.sym("entries", (n + 1) * (n + 2) // 2)
    whole = ca.SX.zeros(n + 1, n + 1)
    for k, (i, j) in enumerate(zip(*np.tril_indices(n + 1), strict=True)):
        whole[int(i), int(j)] = whole[int(j), int(i)] = entries[k]
    Q, R = whole[:n, :n], whole[:n, n]
    f, f_x, f_u = stage.ode, ca.jacobian(stage.ode, x), ca.jacobian(stage.ode, u)
    H_x, H_u = ca.gradient(H, x), ca.gradient(H, u)
    H_xx, H_xu, H_uu = ca.jacobian(H_x, x), ca.jacobian(H_x, u), ca.jacobian(H_u, u)
    Q_rate = -ca.mtimes(Q, f_x) - ca.mtimes(f_x.T, Q) - H_xx
    R_rate = -ca.mtimes(Q, f) - duration * ca.mtimes(f_x.T, R) - H_x
    q_rate = -2.0 * ca.dot(R, f)
    if arc is Arc.INSIDE:
        k, r = H_xu + ca.mtimes(Q, f_u), H_u + duration * ca.mtimes(f_u.T, R)
        Q_rate += ca.mtimes(k, k.T) / H_uu
        R_rate += k * r / H_uu
        q_rate += r * r / H_uu / duration
    rates = ca.vertcat(ca.horzcat(duration * Q_rate, R_rate), ca.horzcat(R_rate.T, q_rate))
    lower = ca.vertcat(*[rates[int(i), int(j)] for i, j in zip(*np.tril_indices(n + 1), strict=True)])
    motion = duration * ca.vertcat(f, principle.adjoint_rate)
    control = principle.control(arc)
    outputs = ca.substitute([ca.vertcat(motion, lower), H_uu], [u], [control])
    state, parameters = ca.vertcat(x, lam, entries), ca.vertcat(principle.theta, principle.p)
    rate, curvature = (
        ca.Function(name, [state, parameters], [out]) for name, out in zip(("r", "H"), outputs, strict=True)
    )
    return rate, curvature


def _is_negative(curvature: ca.Function, states: np.ndarray, parameters: np.ndarray) -> bool:
    values = np.asarray(curvature.map(states.shape[1])(states, parameters))
    return bool(np.all(values > 0.0))


def _symmetric(lower: np.ndarray, n: int) -> np.ndarray:
    matrix = np.zeros((n, n))
    matrix[np.tril_indices(n)] = lower
    return matrix + np.tril(matrix, -1).T


def _unbounded(end: np.ndarray, largest: float, arc: Arc) -> RiccatiTest:
    return RiccatiTest(
        start=np.full_like(end, np.nan), end=end, largest=largest, bounded=False, signs=False, legendre=False,
        reason=f"the Riccati matrix grows without bound while the control is {arc}",
    )  # fmt: skip


def _judge(start: np.ndarray, end: np.ndarray, largest: float, legendre: bool) -> RiccatiTest:
    signs = bool(start[-1, -1] > 0.0)
    reason = "second-order sufficient conditions hold"
    if not legendre:
        reason = "H_uu is not negative on an arc inside the control's bounds"
    elif not signs:
        reason = f"q_T at the start is {start[-1, -1]:.3g}, it must be positive"
    return RiccatiTest(
        start=start, end=end, largest=largest, bounded=True, signs=signs, legendre=legendre, reason=reason
    )
