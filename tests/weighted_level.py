"""A lower level whose solution is known by a formula: weighted distances to fixed points."""

import casadi as ca
import numpy as np
from symbolic_program import SymbolicProgram

from gaitlab.nlp.interior_point import InteriorPoint
from gaitlab.nlp.sensitivity import Sensitivity

SOLVER = InteriorPoint(tol=1e-10)


class WeightedLevel:
    """Minimise sum_i theta_i (x - a_i)' D_i (x - a_i) / 2 with the points a_i and diagonal D_i > 0, rows of arrays."""

    def __init__(self, points, stiffness, measured):
        self.points, self.stiffness, self.measured = (np.asarray(v, dtype=float) for v in (points, stiffness, measured))
        self.n_theta = len(self.points)
        self.asked = []

    def exact(self, theta):
        """The formula: a mean of the points."""
        share = np.asarray(theta)[:, None] * self.stiffness
        return (share * self.points).sum(axis=0) / share.sum(axis=0)

    def loss(self, theta):
        return 0.5 * np.sum((self.exact(theta) - self.measured) ** 2)

    def respond(self, theta, start):
        self.asked.append(theta)
        return WeightedResponse(self, theta, start)

    def from_scratch(self, theta):
        return WeightedResponse(self, theta, np.zeros_like(self.measured))


class WeightedResponse:
    """Its solution for one theta."""

    def __init__(self, level, theta, start):
        self.level = level
        x = ca.SX.sym("x", len(level.measured))
        terms = [
            0.5 * ca.dot(ca.DM(d), (x - ca.DM(a)) ** 2) for a, d in zip(level.points, level.stiffness, strict=True)
        ]
        self.program = SymbolicProgram(x, ca.dot(ca.DM(theta), ca.vertcat(*terms)))
        self.solution = SOLVER.solve(self.program, start)

    @property
    def residual(self):
        return self.solution.w - self.level.measured

    def residual_by_time(self):
        return self.residual[:, None]

    def _moves(self):
        gradients = self.level.stiffness * (self.solution.w - self.level.points)
        return Sensitivity(self.program, self.solution).of_objective(gradients.T)

    def jacobian(self):
        return self._moves()

    def predict(self, step):
        return Sensitivity(self.program, self.solution).predict(self._moves() @ step)
