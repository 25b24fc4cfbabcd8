"""Small optimal control problems whose solutions are known in closed form."""

import casadi as ca
import numpy as np

from gaitlab.ocp.constraint import Bounds, Constraint
from gaitlab.ocp.problem import MultiStageProblem
from gaitlab.ocp.stage import Stage, fixed
from gaitlab.ocp.transition import Transition


def regulator(duration=1.0):
    """min int_0^T x^2 + u^2 dt, dx/dt = u, x(0) = 1: the minimum is tanh T."""
    x, u = ca.SX.sym("x"), ca.SX.sym("u")
    stage = Stage(
        name="regulate", x=x, u=u, ode=u, duration=duration, lagrange={"state": x**2, "control": u**2}, start=fixed(1.0)
    )
    return MultiStageProblem(stages=(stage,))


def shortest_time(speed_limit=np.inf):
    """Move by 1 from rest to rest with |u| <= 1: 2 s, or 1 / limit + limit under a speed limit below 1."""
    x, v, u, duration = (ca.SX.sym(name) for name in ("x", "v", "u", "duration"))
    limit = Constraint(name="speed limit", expression=v, lower=np.array([-np.inf]), upper=np.array([speed_limit]))
    stage = Stage(
        name="move",
        x=ca.vertcat(x, v),
        u=u,
        ode=ca.vertcat(v, u),
        duration=duration,
        mayer={"time": duration},
        u_bounds=Bounds.symmetric(1.0),
        start=fixed(0.0, 0.0),
        end=fixed(1.0, 0.0),
        path=limit,
    )
    bounds = Bounds(lower=np.array([0.1]), upper=np.array([10.0]))
    return MultiStageProblem(stages=(stage,), q=duration, q_bounds=bounds)


def doubling_jump():
    """min int u^2 over two stages of 1 s, dx/dt = u from 0 to 1, doubled in between: u = 0.4, 0.2, minimum 0.2."""
    x, u = ca.SX.sym("x"), ca.SX.sym("u")
    shared = {"x": x, "u": u, "ode": u, "duration": 1.0, "lagrange": {"control": u**2}}
    first, second = Stage(name="before", start=fixed(0.0), **shared), Stage(name="after", end=fixed(1.0), **shared)
    return MultiStageProblem(stages=(first, second), transitions=(Transition(next_state=2 * x),))


def everything():
    """Two stages that use every word of the problem language; no solution is known."""
    x, u, q, p = ca.SX.sym("x", 2), ca.SX.sym("u"), ca.SX.sym("q", 2), ca.SX.sym("p", 2)
    t = ca.SX.sym("t")
    path = Constraint(name="mixed", expression=x[0] * u + p[1] * t, lower=np.array([-9.0]), upper=np.array([9.0]))
    first = Stage(
        name="first", x=x, u=u, t=t, ode=ca.vertcat(x[1] + t, p[0] * ca.sin(x[0]) + u * q[1]), duration=q[0] * p[1],
        lagrange={"effort": u**2 * x[0] + t * u}, mayer={"end": x[0] ** 2 * q[0]}, path=path,
        u_bounds=Bounds.symmetric(3.0), start=fixed(0.3, 0.0),
    )  # fmt: skip
    z = ca.SX.sym("z")
    second = Stage(name="second", x=z, ode=-p[0] * z**2, duration=0.7, mayer={"end": z**3}, lagrange={"size": z**2})
    problem = MultiStageProblem(
        stages=(first, second), transitions=(Transition(next_state=x[0] * x[1] + q[1] * p[0]),), q=q, p=p
    )
    return problem
