"""Derivatives of solutions with respect to parameters, against solving again."""

import casadi as ca
import numpy as np
import pytest
from symbolic_program import SymbolicProgram

from gaitlab.nlp.interior_point import InteriorPoint
from gaitlab.nlp.sensitivity import Sensitivity

START = np.array([1.0, 5.0, 5.0, 1.0])
TERMS = 2


def weighted(theta):
    """Hock and Schittkowski's number 71 with two weighted terms in the objective; gradients of these terms."""
    x = ca.SX.sym("x", 4)
    terms = ca.vertcat(x[0] * x[3] * (x[0] + x[1] + x[2]), x[2] ** 2 + x[3] ** 2)
    limits = [x[0] * x[1] * x[2] * x[3] - 25, *[x[i] - 1 for i in range(4)], *[5 - x[i] for i in range(4)]]
    program = SymbolicProgram(x, ca.dot(theta, terms), g=[ca.sumsqr(x) - 40], c=limits)
    return program, ca.Function("gradients", [x], [ca.jacobian(terms, x).T])


def solved(theta, start=START):
    """Smooth in theta: the barrier parameter stays at 1e-3."""
    program, gradients = weighted(theta)
    return program, gradients, InteriorPoint(tol=1e-11, mu_final=1e-3).solve(program, start)


@pytest.mark.parametrize("theta", [(1.0, 0.3), (0.2, 1.0)])
def test_derivative_of_the_solution_in_the_weights(theta):
    program, gradients, solution = solved(np.array(theta))
    sensitivity = Sensitivity(program, solution)
    found = sensitivity.of_objective(gradients(solution.w).full())
    step = 1e-4
    for j, direction in enumerate(np.eye(TERMS)):
        ends = [solved(np.array(theta) + sign * step * direction, solution.w)[2] for sign in (1, -1)]
        difference = [np.concatenate([end.w, end.lam_g]) for end in ends]
        np.testing.assert_allclose(found[:, j], (difference[0] - difference[1]) / (2 * step), rtol=1e-3, atol=1e-5)


def test_predictions_are_of_first_order():
    """Halving the move divides the error of the prediction by four."""
    theta, direction = np.array([1.0, 0.3]), np.array([-0.2, 0.4])
    program, gradients, solution = solved(theta)
    sensitivity = Sensitivity(program, solution)
    moves = sensitivity.of_objective(gradients(solution.w).full()) @ direction
    errors = []
    for size in (0.04, 0.02, 0.01):
        predicted, exact = sensitivity.predict(size * moves), solved(theta + size * direction, solution.w)[2]
        errors.append(np.abs(predicted.w - exact.w).max())
        assert np.all(predicted.s > 0.0)
        assert np.all(predicted.lam_c > 0.0)
    assert errors[0] / errors[1] > 3.0
    assert errors[1] / errors[2] > 3.0


def test_saddles_are_no_minima():
    x = ca.SX.sym("x", 2)
    minimum = SymbolicProgram(x, ca.sumsqr(x))
    solution = InteriorPoint().solve(minimum, np.ones(2))
    assert Sensitivity(minimum, solution).is_minimum()
    saddle = SymbolicProgram(x, x[0] ** 2 - x[1] ** 2)
    assert not Sensitivity(saddle, solution).is_minimum()
