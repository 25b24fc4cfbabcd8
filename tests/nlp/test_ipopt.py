import casadi as ca
import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.nlp.ipopt import Ipopt
from gaitlab.nlp.problem import NLP
from gaitlab.nlp.solution import KKTResiduals, kkt_residuals


@pytest.fixture
def hock_schittkowski_71():
    """Number 71, the right-hand side of the inequality a parameter."""
    w, p = ca.SX.sym("w", 4), ca.SX.sym("p")
    return NLP(
        w=w,
        p=p,
        f=w[0] * w[3] * (w[0] + w[1] + w[2]) + w[2],
        g=ca.vertcat(w[0] * w[1] * w[2] * w[3], ca.sumsqr(w)),
        lbw=np.ones(4),
        ubw=np.full(4, 5.0),
        lbg=np.array([25.0, 40.0]),
        ubg=np.array([np.inf, 40.0]),
    )


def test_known_solution_with_its_certificate(hock_schittkowski_71):
    solution = Ipopt().solve(hock_schittkowski_71, np.array([1.0, 5.0, 5.0, 1.0]), np.array([25.0]))
    np.testing.assert_allclose(solution.w, [1.0, 4.74299963, 3.82114998, 1.37940829], atol=1e-6)
    assert solution.is_optimal(1e-6)
    assert solution.lam_w[0] < 0.0  # The lower bound of the first variable is active.


def test_the_certificate_sees_wrong_points_and_multipliers(hock_schittkowski_71):
    p = np.array([25.0])
    solution = Ipopt().solve(hock_schittkowski_71, np.array([1.0, 5.0, 5.0, 1.0]), p)
    elsewhere = kkt_residuals(hock_schittkowski_71, solution.w + 0.1, solution.lam_w, solution.lam_g, p)
    assert min(elsewhere.stationarity, elsewhere.primal, elsewhere.complementarity) > 1e-2
    assert kkt_residuals(hock_schittkowski_71, solution.w, 0 * solution.lam_w, solution.lam_g, p).stationarity > 0.5


def test_not_converging_is_a_result(hock_schittkowski_71):
    solution = Ipopt(max_iter=1).solve(hock_schittkowski_71, np.array([1.0, 5.0, 5.0, 1.0]), np.array([25.0]))
    assert not solution.is_optimal(1e-6)
    assert "Maximum_Iterations" in solution.status


def test_bounds_of_wrong_shape_are_refused():
    w = ca.SX.sym("w", 2)
    bounds = {"lbw": np.zeros(2), "ubw": np.ones(3), "lbg": np.zeros(0), "ubg": np.zeros(0)}
    with pytest.raises(ProblemError, match=r"ubw must have shape \(2,\)"):
        NLP(w=w, p=ca.SX.sym("p", 0), f=ca.sumsqr(w), g=ca.SX(0, 1), **bounds)


@pytest.mark.parametrize("place", ["stationarity", "primal", "complementarity"])
def test_a_residual_that_is_no_number_is_never_small(place):
    residuals = KKTResiduals(**({"stationarity": 0.0, "primal": 0.0, "complementarity": 0.0} | {place: np.nan}))
    assert not residuals.max() < 1e9
