"""The identical program written plainly with casadi.Opti and solved by IPOPT: the peer of the banded method.

Same unknowns, constraints, cost and start as a `MechanicalProblem`: CasADi differentiates the whole program, IPOPT
factorises it with MUMPS as it comes in the wheel.
"""

import time
from dataclasses import dataclass

import casadi as ca
import numpy as np

from gaitlab.multibody.dynamics import ModelLayout
from gaitlab.transcription.mechanical_problem import MechanicalProblem
from gaitlab.walking.model import walking_model


@dataclass(frozen=True, kw_only=True)
class OptiResult:
    """What the peer found."""

    w: np.ndarray
    """Variables in the order of the problem, shape (n_w,)."""
    f: float
    success: bool
    iterations: int
    build_seconds: float
    """Processor time to write the program and its derivatives [s]."""
    solve_seconds: float
    """Processor time of the solver [s]."""


def solve_with_opti(
    problem: MechanicalProblem, model: ModelLayout, start: np.ndarray, max_iter: int = 1000
) -> OptiResult:
    """Solve from a start, shape (n_w,), to the accuracy of the banded method (1e-8)."""
    begin = time.process_time()
    opti = ca.Opti()
    w = opti.variable(problem.structure.n_w)
    opti.minimize(_pose(opti, problem, model, w))
    opti.set_initial(w, start)
    settings = {"print_level": 0, "tol": 1e-8, "max_iter": max_iter, "sb": "yes"}
    opti.solver("ipopt", {"print_time": False}, settings)
    build = time.process_time() - begin
    begin, success = time.process_time(), True
    try:
        found = opti.solve()
        value = np.array(found.value(w)).ravel()
    except RuntimeError:  # CasADi's word for a solver that stopped early
        success, value = False, np.array(opti.debug.value(w)).ravel()
    return OptiResult(
        w=value,
        f=problem.values(value).f,
        success=success,
        iterations=int(opti.stats()["iter_count"]),
        build_seconds=build,
        solve_seconds=time.process_time() - begin,
    )


def _pose(opti: ca.Opti, problem: MechanicalProblem, model: ModelLayout, w: ca.MX) -> ca.MX:
    """Add the constraints; returns the cost."""
    shared, data, layout = problem.shared, problem.data, problem.shared.layout
    functions = _plain_functions(model)
    n, width = layout.n_intervals, 2 * layout.n_q
    states = ca.reshape(w[: width * (n + 1)], width, n + 1)
    cost = 0.5 * ca.sum1(ca.sum2(ca.DM(data.tracking.T) * (states - ca.DM(data.reference.T)) ** 2))
    for k in range(2 * n):
        cost += _point(opti, problem, functions, (w, states), k)
    contact = [functions["contact"](states[:, k], data.p) for k in range(n + 1)]
    for row in shared.contact:
        before = contact[row.minus_node][row.component] if row.minus_node >= 0 else 0
        opti.subject_to(contact[row.node][row.component] - before == 0)
    for row in shared.clear:
        opti.subject_to(contact[row.node][row.component] + data.allowance >= 0)
    for column in shared.fixed_columns:
        opti.subject_to(w[int(column)] == float(data.given.ravel()[column]))
    rows, columns, values = shared.cone
    if shared.n_cone:
        cone = ca.DM(ca.Sparsity.triplet(shared.n_cone, w.numel(), rows.tolist(), columns.tolist()))
        for row, column, value in zip(rows.tolist(), columns.tolist(), values.tolist(), strict=True):
            cone[row, column] = value
        opti.subject_to(cone @ w >= 0)
    for column in shared.limits:
        coordinate = int(column) % width
        opti.subject_to(opti.bounded(data.lower[coordinate], w[int(column)], data.upper[coordinate]))
    return cost


def _point(
    opti: ca.Opti, problem: MechanicalProblem, functions: dict[str, ca.Function], unknowns: tuple[ca.MX, ca.MX], k: int
) -> ca.MX:
    """Equations of motion at one Gauss point; returns its part of the cost."""
    shared, data, n_q = problem.shared, problem.data, problem.shared.layout.n_q
    w, states = unknowns
    x = ca.vertcat(states[:, k // 2], states[:, k // 2 + 1])
    nodes = ca.horzcat(*[x[i * n_q : (i + 1) * n_q] for i in range(4)])
    motion = nodes @ ca.DM(shared.coefficients[k].T)  # (n_q, 3): q, v, a
    forces = ca.vertcat(*[w[int(i)] if i >= 0 else 0 for i in shared.force_index[k]])
    y = functions["outputs"](ca.vertcat(ca.vec(motion), forces), data.p)
    opti.subject_to(y[: shared.layout.n_r] == 0)
    criteria = functions["criteria"](y, motion[:, 1], data.p, shared.data[k])
    smooth = 0.5 * ca.dot(ca.DM(data.acceleration_weights), motion[:, 2] ** 2)
    running = ca.dot(ca.DM(data.theta), criteria) + smooth + 0.5 * data.force_weight * ca.sumsqr(forces)
    return float(shared.weights[k]) * running


def _plain_functions(model: ModelLayout) -> dict[str, ca.Function]:
    m = walking_model(model)
    z, x = ca.vertcat(m.q, m.v, m.a, m.f), ca.vertcat(m.q, m.v)
    return {
        "outputs": ca.Function("outputs", [z, m.p], [m.outputs]),
        "criteria": ca.Function("criteria", [m.y, m.v, m.p, m.d], [m.criteria]),
        "contact": ca.Function("contact", [x, m.p], [ca.vertcat(m.positions, m.velocities)]),
    }
