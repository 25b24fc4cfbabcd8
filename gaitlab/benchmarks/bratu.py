"""Bratu's boundary value problem: the largest heat release with a steady state.

y'' + q exp(y) = 0 on [0, 1], y(0) = y(1) = 0. Solutions y = -2 ln(cosh(c (t - 1/2)) / cosh(c / 2)) with
q = 2 c^2 / cosh(c / 2)^2 exist up to the fold where (c / 2) tanh(c / 2) = 1 (Ascher, Mattheij, Russell, Numerical
Solution of Boundary Value Problems, SIAM 1995, p. 134: q* = 3.513830719).
"""

import casadi as ca
import numpy as np
from scipy.optimize import brentq

from ..continuation.collocation_mesh import Mesh
from ..continuation.collocation_problem import Segment
from ..continuation.extremum import ExtremumProblem
from ..continuation.zero_problem import ZeroProblem

CRITICAL = 3.513830719
"""Published value of q at the fold."""


def exact_critical() -> float:
    """The fold from the formula: 8 (a / cosh a)^2 with a tanh a = 1."""
    a, _ = brentq(_slope, 0.5, 2.0, xtol=1e-15, full_output=True)
    return float(8.0 * (a / np.cosh(a)) ** 2)


def _slope(a: float) -> float:
    """Zero where q has its maximum."""
    return a * float(np.tanh(a)) - 1.0


def exact_solution(t: np.ndarray, c: float) -> tuple[np.ndarray, float]:
    """Solution y at times t in [0, 1], shape (n_t,), and its q, for the family parameter c."""
    return -2.0 * np.log(np.cosh(c * (t - 0.5)) / np.cosh(c / 2.0)), 2.0 * (c / np.cosh(c / 2.0)) ** 2


def segment(mesh: Mesh) -> Segment:
    """The differential equation as a first-order system in (y, y')."""
    return Segment(name="rod", mesh=mesh, field=lambda t, x, p: ca.vertcat(x[1], -p * ca.exp(x[0])), n_x=2, n_p=1)


def bratu_problem(mesh: Mesh) -> ZeroProblem:
    """The boundary value problem with the monitor 'q', starting at y = 0, q = 0."""
    rod = segment(mesh)
    problem = rod.add_to(ZeroProblem(), np.zeros((mesh.n_points, 2)), 1.0, np.zeros(1))
    problem = rod.add_ends(problem, "walls", lambda first, last, T, p: ca.vertcat(first[0], last[0], T - 1.0))
    return problem.add_parameters(("q",), "rod.p")


def bratu(n_intervals: int = 10) -> ExtremumProblem:
    """The largest q."""
    problem = bratu_problem(Mesh.uniform(n_intervals))
    return ExtremumProblem(problem=problem, objective="q", parameters=(), maximise=True, bounds={"q": (-0.1, 10.0)})
