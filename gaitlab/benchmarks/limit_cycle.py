"""Limit cycles known by formula: the optimum of an integral over the orbits of an autonomous system.

In polar coordinates r' = r (a - r^2), angle' = 1 + r^2 with a = 1 - (p1 - 1)^2 - (p2 + 1/2)^2 / 2: the cycle has
r^2 = a and the period 2 pi / (1 + a). The mean of x^2 over time is a / 2, largest (one half) at p = (1, -1/2). With the
inequality p1 <= b < 1 the optimum is (1 - (b - 1)^2) / 2 at p = (b, -1/2), and its multiplier is 1 - b.
"""

from collections.abc import Callable

import casadi as ca
import numpy as np

from ..continuation.collocation_mesh import Mesh
from ..continuation.collocation_problem import Segment
from ..continuation.extremum import ExtremumProblem
from ..continuation.zero_problem import ZeroProblem

START = np.array([0.6, -0.2])
PARAMETERS = ("p1", "p2")


def squared_radius(p: np.ndarray) -> float:
    """Of the cycle, for p of shape (2,)."""
    return float(1.0 - (p[0] - 1.0) ** 2 - (p[1] + 0.5) ** 2 / 2.0)


def field(t: ca.SX, x: ca.SX, p: ca.SX) -> ca.SX:
    """The system in Cartesian coordinates."""
    del t  # Unused.
    square = ca.sumsqr(x)
    growth = 1.0 - (p[0] - 1.0) ** 2 - (p[1] + 0.5) ** 2 / 2.0 - square
    return growth * x + (1.0 + square) * ca.vertcat(-x[1], x[0])


def cycle(mesh: Mesh, p: np.ndarray) -> tuple[Segment, ZeroProblem]:
    """Orbits of the system, starting at the exact cycle for p, shape (2,), with the monitor 'mean square'."""
    a, angle = squared_radius(p), 2.0 * np.pi * mesh.points
    x = np.sqrt(a) * np.column_stack([np.cos(angle), np.sin(angle)])
    segment = Segment(name="orbit", mesh=mesh, field=field, n_x=2, n_p=2)
    problem = segment.add_to(ZeroProblem(), x, 2.0 * np.pi / (1.0 + a), p)
    problem = segment.add_periodicity(problem, autonomous=True)
    problem = segment.add_integral(problem, "mean square", lambda t, x, p: x[0] ** 2, mean=True)
    return segment, problem.add_parameters(PARAMETERS, "orbit.p")


def _above(bound: float) -> Callable[[ca.SX], ca.SX]:
    return lambda p: p - bound


def limit_cycle(n_intervals: int = 10, bound: float | None = None) -> ExtremumProblem:
    """The largest mean of x^2, with the inequality p1 <= bound where one is given."""
    _, problem = cycle(Mesh.uniform(n_intervals), START)
    if bound is not None:
        problem = problem.add_inequality("limit", _above(bound), problem.indices("orbit.p")[:1])
    return ExtremumProblem(problem=problem, objective="mean square", parameters=PARAMETERS, maximise=True)
