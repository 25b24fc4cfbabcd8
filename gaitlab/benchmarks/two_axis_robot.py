r"""Planar two-axis robot: least peak of the tool's speed in a rest-to-rest motion.

Zallinger et al. (2025), section 5.2, (40)-(43) and Table 2. The equations of motion are not printed (they refer to
Eichmeir et al. 2021); they follow here from the energies with absolute angles, as (41) uses them, in a horizontal
plane, as no gravity is mentioned. That reading gives the printed optimum and its seven equal maxima.
"""

import casadi as ca
import numpy as np

from ..ocp.extremal import ExtremalProblem

LENGTH = 1.0
"""Of both bodies [m]."""
CENTRE = 0.5
"""Distance of the centre of mass from the joint, both bodies [m]."""
MASSES = (1.0, 0.5, 1.0)
"""Body 1, body 2, tool [kg]."""
INERTIAS = (0.0833, 0.0417)
"""About the centres of mass [kg m^2]."""

PUBLISHED_PEAK = 1.249
"""Speed [m/s] of the source by goal attainment, with 7 equal maxima; approx. 100 iterations, 41 s (p-norm: 62 s)."""


def two_axis_robot() -> ExtremalProblem:
    r"""Build the problem with :math:`h = \tfrac{1}{2} |v_{TCP}|^2`, (43)."""
    x, u, t = ca.SX.sym("x", 4), ca.SX.sym("u", 2), ca.SX.sym("t")
    angles, rates = x[:2], x[2:]
    tool = LENGTH * ca.vertcat(ca.sum1(ca.cos(angles)), ca.sum1(ca.sin(angles)))
    speed = ca.jtimes(tool, angles, rates)
    return ExtremalProblem(
        x=x,
        u=u,
        t=t,
        dynamics=ca.vertcat(rates, _accelerations(angles, rates, u)),
        outputs=0.5 * ca.sumsqr(speed),
        terminal=ca.vertcat(tool - 1.0, rates),
        x0=np.array([-np.pi / 4, 0.0, 0.0, 0.0]),
        duration=2.0,
        lower=np.array([-4.0, -2.0]),
        upper=np.array([4.0, 2.0]),
    )


def tool_speed(value: float) -> float:
    """Speed [m/s] of an output h = v^2 / 2 [m^2/s^2]."""
    return float(np.sqrt(2.0 * value))


def _accelerations(angles: ca.SX, rates: ca.SX, u: ca.SX) -> ca.SX:
    """Lagrange's equations of two links with absolute angles, the second motor standing on the first body."""
    (first, second, tool), difference = MASSES, angles[0] - angles[1]
    coupling = (second * CENTRE + tool * LENGTH) * LENGTH
    diagonal = (
        INERTIAS[0] + first * CENTRE**2 + (second + tool) * LENGTH**2,
        INERTIAS[1] + second * CENTRE**2 + tool * LENGTH**2,
    )
    off = coupling * ca.cos(difference)
    right = ca.vertcat(u[0] - u[1], u[1]) + coupling * ca.sin(difference) * ca.vertcat(-(rates[1] ** 2), rates[0] ** 2)
    determinant = diagonal[0] * diagonal[1] - off**2
    return ca.vertcat(diagonal[1] * right[0] - off * right[1], diagonal[0] * right[1] - off * right[0]) / determinant
