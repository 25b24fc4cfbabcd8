r"""One-mass oscillator: least peak of the reaction force in a rest-to-rest motion.

Zallinger et al. (2025), section 5.1, (37)-(39): m = 1 kg, c = 1 N/m, d = 0.5 N s/m, from rest at 0 to rest at 1 m
within 0.9 s, force within +-16 N at the 20 nodes of its spline. The end conditions of the spline are not printed; those
of `ControlSpline` reproduce the printed start (1.504 N) and optimum. As the system is linear, the optimum is that of a
linear program, which the tests solve independently.
"""

import casadi as ca
import numpy as np

from ..ocp.extremal import ExtremalProblem

STIFFNESS = 1.0
"""[N/m]"""
DAMPING = 0.5
"""[N s/m]"""

PUBLISHED_PEAK = 1.251
"""Reaction force [N] of the source by goal attainment, with 8 equal maxima; approx. 190 iterations, 16 s."""
PUBLISHED_P_NORM_PEAK = 1.253
"""Reaction force [N] of the source by the p-norm with exponent 1000; 10 iterations more, 21 s."""


def one_mass_oscillator() -> ExtremalProblem:
    r"""Build the problem with :math:`h = \tfrac{1}{2} F^2, \; F = c x + d v`, (38)."""
    x, u, t = ca.SX.sym("x", 2), ca.SX.sym("u"), ca.SX.sym("t")
    force = STIFFNESS * x[0] + DAMPING * x[1]
    return ExtremalProblem(
        x=x,
        u=u,
        t=t,
        dynamics=ca.vertcat(x[1], u - force),
        outputs=0.5 * force**2,
        terminal=ca.vertcat(x[0] - 1.0, x[1]),
        x0=np.zeros(2),
        duration=0.9,
        lower=np.array([-16.0]),
        upper=np.array([16.0]),
    )


def reaction_force(value: float) -> float:
    """Reaction force F [N] of an output h = F^2 / 2 [N^2]."""
    return float(np.sqrt(2.0 * value))
