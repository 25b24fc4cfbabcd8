import numpy as np
import pytest

from gaitlab.nlp.null_space.feasibility import meet_constraints, meet_equalities
from gaitlab.nlp.null_space.line_search import StepLengths
from gaitlab.nlp.null_space.problem import BlackBoxProblem, Evaluations

STEPS = StepLengths()


def evaluations(x, **functions):
    return Evaluations(BlackBoxProblem(cost=lambda x: float(x @ x), **functions), x)


def test_later_equalities_leave_earlier_ones_alone():
    x = np.array([3.0, 2.0, -1.0])
    functions = evaluations(x, equality=lambda x: np.array([x[0] + x[1] - 1.0, x[0] - x[2] + 4.0]))
    found, rows = meet_equalities(functions, x, STEPS, 1e-4)
    np.testing.assert_allclose(functions.equality(found), 0.0, atol=1e-5)
    np.testing.assert_allclose(rows, [[1, 1, 0], [1, 0, -1]], atol=1e-6)


def test_inequalities_are_active_near_their_bound():
    x = np.array([0.5, 1.0 - 1e-6, 5.0])
    functions = evaluations(x, inequality=lambda x: 100.0 * (x - 1.0))
    feasible = meet_constraints(functions, x, STEPS, 1e-4)
    assert feasible.active.tolist() == [1, 2]
    assert feasible.x[2] == pytest.approx(1.0, abs=1e-4)


def test_constraints_that_repeat_each_other():
    x = np.array([3.0, 2.0])
    functions = evaluations(x, equality=lambda x: np.array([x[0] - 1.0, 2.0 * x[0] - 2.0, 0.0 * x[1]]))
    found, _ = meet_equalities(functions, x, STEPS, 1e-4)
    np.testing.assert_allclose(found, [1.0, 2.0], atol=1e-5)
