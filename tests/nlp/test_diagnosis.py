import casadi as ca
import numpy as np
import pytest
from inverse_toys import INF, program

from gaitlab.nlp.diagnosis import blame, dependent_constraint, invalid_function
from gaitlab.nlp.outcome import Outcome

NONE = np.zeros(0)
P = ca.SX(0, 1)


def test_the_worst_constraint_is_named_with_its_bounds():
    w = ca.SX.sym("w", 2)
    nlp = program(w, P, ca.sumsqr(w), [w[0], w[0] + w[1]], lbg=[0.0, 3.0])
    sentence = blame(nlp, np.array([-1.0, 1.0]), NONE, Outcome.INFEASIBLE)
    assert "g[1] = 0 misses its bounds [3, inf] by 3" in sentence


def test_a_variable_that_runs_away_is_named():
    w = ca.SX.sym("w", 2)
    assert "w[1] runs to -1e+12" in blame(program(w, P, w[1]), np.array([0.0, -1e12]), NONE, Outcome.UNBOUNDED)


@pytest.mark.parametrize(
    ("f", "g", "word"),
    [
        (lambda w: ca.log(w), lambda w: w, "the objective"),
        (lambda w: w, lambda w: ca.sqrt(w - 1), r"constraint g[0] is nan"),
        (lambda w: ca.sqrt(w), lambda w: w, "derivative of objective with respect to w[0]"),
    ],
)
def test_functions_that_are_not_finite_are_named(f, g, word):
    w = ca.SX.sym("w")
    assert word in invalid_function(program(w, P, f(w), [g(w)]), np.zeros(1), NONE)


def test_a_dependent_equation_is_found():
    w = ca.SX.sym("w", 3)
    rows = [w[0] + w[1], w[2], 2 * w[0] + 2 * w[1]]
    nlp = program(w, P, ca.sumsqr(w), rows, lbg=np.zeros(3), ubg=np.zeros(3))
    assert dependent_constraint(nlp, np.zeros(3), NONE) in (0, 2)
    assert "depends linearly" in blame(nlp, np.zeros(3), NONE, Outcome.STALLED)


def test_independent_equations_are_not_blamed():
    w = ca.SX.sym("w", 2)
    nlp = program(w, P, ca.sumsqr(w), [w[0], w[0] + w[1]], lbg=np.zeros(2), ubg=np.array([0.0, INF]))
    assert dependent_constraint(nlp, np.zeros(2), NONE) is None
