"""AUTO-07p's demo `opt`: the largest sum of coordinates on the unit sphere of five dimensions.

Source: Doedel and Oldeman, AUTO-07p: Continuation and Bifurcation Software for Ordinary Differential Equations,
Concordia University 2012, demo opt (equations in demos/opt/opt.f90): x^2 + p_1^2 + ... + p_4^2 = 1, objective
x + p_1 + ... + p_4, start at x = 1. Released one after the other, the parameters lead to folds of the objective at the
square roots of 2, 3, 4 and 5.
"""

import casadi as ca
import numpy as np

from ..continuation.extremum import ExtremumProblem
from ..continuation.zero_problem import ZeroProblem

PARAMETERS = ("p1", "p2", "p3", "p4")
MAXIMA = (np.sqrt(2.0), np.sqrt(3.0), 2.0, np.sqrt(5.0))
"""Exact maxima over one to four parameters, by the inequality of Cauchy and Schwarz."""


def sphere() -> ZeroProblem:
    """The sphere with the monitors 'sum' and the four parameters."""
    problem = ZeroProblem().add_variables("x", np.ones(1)).add_variables("p", np.zeros(4))
    problem = problem.add_zero("sphere", _on_sphere, "x", "p").add_monitor("sum", _sum, "x", "p")
    return problem.add_parameters(PARAMETERS, "p")


def _on_sphere(x: ca.SX, p: ca.SX) -> ca.SX:
    return ca.sumsqr(x) + ca.sumsqr(p) - 1.0


def _sum(x: ca.SX, p: ca.SX) -> ca.SX:
    return x + ca.sum1(p)


def auto_opt() -> ExtremumProblem:
    """The demo as one problem."""
    return ExtremumProblem(problem=sphere(), objective="sum", parameters=PARAMETERS, maximise=True)
