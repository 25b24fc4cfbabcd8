"""One integration interval of an extremal problem as CasADi functions: step, dense output, derivatives.

The state at the end follows from the classical Runge-Kutta step with controls at the start, the middle and the end;
in between it is the cubic Hermite polynomial of both ends, so outputs have a continuous slope in time.
"""

from dataclasses import dataclass

import casadi as ca

from ..ocp.extremal import ExtremalProblem


@dataclass(frozen=True, kw_only=True)
class IntervalFunctions:
    """Functions of one interval; z = (state at the start, three controls), y = (z, control and its slope at the probe).

    A probe is a time t + s h within the interval that starts at t; `e` weighs the outputs.
    """

    step: ca.Function
    """(x, three controls, t) -> state at the end."""
    step_jacobian: ca.Function
    """(x, three controls, t) -> its Jacobian in z, shape (n_x, n_z)."""
    step_hessian: ca.Function
    """(x, three controls, t, lam) -> Hessian of lam' (state at the end) in z."""
    grid: ca.Function
    """(x, u, du/dt, t) -> h and dh/dt at a grid point, shapes (n_h, 1)."""
    probe: ca.Function
    """(y, d2u/dt2, t, s, e) -> e'h and its first and second time derivatives."""
    probe_gradient: ca.Function
    """(y, t, s, e) -> gradients of e'h and of its time derivative in y."""
    probe_hessian: ca.Function
    """(y, t, s, e) -> Hessian of e'h in y."""
    terminal: ca.Function
    """x -> phi and its Jacobian."""
    terminal_hessian: ca.Function
    """(x, lam) -> Hessian of lam' phi."""


def interval_functions(problem: ExtremalProblem, h: float) -> IntervalFunctions:
    """Functions of intervals of length h [s]."""
    n_x, n_u, n_h = problem.x.numel(), problem.u.numel(), problem.outputs.numel()
    f = ca.Function("f", [problem.x, problem.u, problem.t], [problem.dynamics])
    x, c = ca.SX.sym("x", n_x), ca.SX.sym("c", 3 * n_u)
    t, s = ca.SX.sym("t"), ca.SX.sym("s")
    u, du, ddu = (ca.SX.sym(name, n_u) for name in ("u", "du", "ddu"))
    lam, e = ca.SX.sym("lam", n_x), ca.SX.sym("e", n_h)
    lam_end = ca.SX.sym("lam_end", problem.terminal.numel())
    after = _runge_kutta(f, x, c, t, h)
    z, y = ca.vertcat(x, c), ca.vertcat(x, c, u, du)
    first, _, last = ca.vertsplit(c, n_u)
    path = _hermite((x, after), (f(x, first, t), f(after, last, t + h)), s, h)
    rate = ca.jacobian(path, s) / h
    value = _at(problem, e, path, u, t + s * h)
    slope = _slope(problem, e, path, rate, (u, du), t + s * h)
    curvature = ca.jacobian(slope, s) / h + ca.jtimes(slope, u, du) + ca.jtimes(slope, du, ddu)
    node = (_at(problem, e, x, u, t), _slope(problem, e, x, f(x, u, t), (u, du), t))
    phi = problem.terminal
    return IntervalFunctions(
        step=ca.Function("step", [x, c, t], [after]),
        step_jacobian=ca.Function("step_jacobian", [x, c, t], [ca.densify(ca.jacobian(after, z))]),
        step_hessian=_hessian("step_hessian", ca.dot(lam, after), z, [x, c, t, lam]),
        grid=ca.Function("grid", [x, u, du, t], [ca.densify(ca.jacobian(part, e).T) for part in node]),
        probe=ca.Function("probe", [y, ddu, t, s, e], [value, slope, curvature]),
        probe_gradient=ca.Function(
            "probe_gradient", [y, t, s, e], [ca.densify(ca.gradient(value, y)), ca.densify(ca.gradient(slope, y))]
        ),
        probe_hessian=_hessian("probe_hessian", value, y, [y, t, s, e]),
        terminal=ca.Function("terminal", [problem.x], [phi, ca.densify(ca.jacobian(phi, problem.x))]),
        terminal_hessian=_hessian("terminal_hessian", ca.dot(lam_end, phi), problem.x, [problem.x, lam_end]),
    )


def _runge_kutta(f: ca.Function, x: ca.SX, c: ca.SX, t: ca.SX, h: float) -> ca.SX:
    first, middle, last = ca.vertsplit(c, c.numel() // 3)
    k1 = f(x, first, t)
    k2 = f(x + h / 2 * k1, middle, t + h / 2)
    k3 = f(x + h / 2 * k2, middle, t + h / 2)
    k4 = f(x + h * k3, last, t + h)
    return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def _hermite(ends: tuple[ca.SX, ca.SX], rates: tuple[ca.SX, ca.SX], s: ca.SX, h: float) -> ca.SX:
    turn = (1 + 2 * s) * (1 - s) ** 2 * ends[0] + s**2 * (3 - 2 * s) * ends[1]
    return turn + h * s * (1 - s) ** 2 * rates[0] + h * s**2 * (s - 1) * rates[1]


def _at(problem: ExtremalProblem, e: ca.SX, x: ca.SX, u: ca.SX, t: ca.SX) -> ca.SX:
    """Output e'h at a state, control and time."""
    h = ca.Function("h", [problem.x, problem.u, problem.t, e], [ca.dot(e, problem.outputs)])
    return h(x, u, t, e)


def _slope(problem: ExtremalProblem, e: ca.SX, x: ca.SX, rate: ca.SX, control: tuple[ca.SX, ca.SX], t: ca.SX) -> ca.SX:
    """d(e'h)/dt = h_x dx/dt + h_u du/dt + h_t."""
    dx, du = ca.SX.sym("dx", x.numel()), ca.SX.sym("du", problem.u.numel())
    h, inputs = ca.dot(e, problem.outputs), [problem.x, problem.u, problem.t]
    total = ca.jtimes(h, problem.x, dx) + ca.jtimes(h, problem.u, du) + ca.gradient(h, problem.t)
    return ca.Function("slope", [*inputs, dx, du, e], [total])(x, control[0], t, rate, control[1], e)


def _hessian(name: str, scalar: ca.SX, variables: ca.SX, inputs: list[ca.SX]) -> ca.Function:
    return ca.Function(name, inputs, [ca.densify(ca.hessian(scalar, variables)[0])])
