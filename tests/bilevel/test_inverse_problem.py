import casadi as ca
import numpy as np
import pytest

from gaitlab.bilevel.inverse_problem import InverseProblem
from gaitlab.errors import ProblemError
from gaitlab.nlp.problem import NLP

INF = np.inf


def weighted_mean(**changes):
    """The minimiser of sum_i p_i (w - i)^2 is the weighted mean of 0, 1, 2."""
    w, p = ca.SX.sym("w"), ca.SX.sym("p", 3)
    f = ca.dot(p, (w - ca.DM([0.0, 1.0, 2.0])) ** 2)
    nlp = NLP(w=w, p=p, f=f, g=ca.SX(0, 1), lbw=-np.full(1, INF), ubw=np.full(1, INF), lbg=np.zeros(0), ubg=np.zeros(0))
    fields = {
        "nlp": nlp,
        "residual": w - 0.5,
        "free": np.ones(3, dtype=bool),
        "lbp": np.zeros(3),
        "ubp": np.ones(3),
        "p_nominal": np.full(3, 1 / 3),
        "simplex": (0, 1, 2),
    }
    return InverseProblem(**(fields | changes))


def test_start_is_the_nearest_point_of_the_simplex():
    np.testing.assert_allclose(weighted_mean().start(np.array([0.5, 0.9, 3.0])), [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(weighted_mean().start(np.array([0.6, 0.5, 0.2])), [0.5, 0.4, 0.1], atol=1e-12)


def test_start_keeps_fixed_entries_and_bounds():
    problem = weighted_mean(simplex=(), free=np.array([True, False, True]))
    np.testing.assert_allclose(problem.start(np.array([-2.0, 5.0, 7.0])), [0.0, 1 / 3, 1.0])


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"lbp": np.zeros(2)}, r"lbp must have shape \(3,\)"),
        ({"free": np.ones(3)}, "booleans"),
        ({"free": np.zeros(3, dtype=bool), "simplex": ()}, "nothing is to be estimated"),
        ({"residual": ca.SX(0, 1)}, "residual must have shape"),
        ({"residual": ca.SX.sym("z")}, "residual depends on z"),
        ({"p_nominal": np.array([1.0, np.nan, 0.0])}, r"p\[1\] is nan"),
        ({"lbp": np.array([0.0, 2.0, 0.0]), "names": ("speed", "effort", "hip")}, "bounds of effort cross"),
        ({"simplex": (0, 0)}, "simplex must list different"),
        ({"ubp": np.full(3, 0.2)}, "cannot sum to 1"),
        ({"upper": ca.SX(1, 1), "lbu": np.ones(1), "ubu": np.zeros(1)}, "upper-level constraint 0"),
    ],
)
def test_malformed_problems_are_refused_by_name(changes, sentence):
    with pytest.raises(ProblemError, match=sentence):
        weighted_mean(**changes)


def test_fixed_weights_leave_the_rest_of_one():
    problem = weighted_mean(free=np.array([False, True, True]), p_nominal=np.array([0.4, 0.3, 0.3]))
    np.testing.assert_allclose(problem.start(np.array([0.0, 0.5, 0.2])), [0.4, 0.45, 0.15], atol=1e-12)


def test_a_start_that_is_no_number_is_refused():
    with pytest.raises(ProblemError, match=r"p0 of p\[0\] is nan"):
        weighted_mean().start(np.array([np.nan, 0.5, 0.5]))
