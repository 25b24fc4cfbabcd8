"""A peak as a criterion of the lower level, its weight from measurements."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.bilevel.gauss_newton import GaussNewton
from gaitlab.bilevel.inverse_problem import InverseProblem
from gaitlab.nlp.epigraph import with_peak
from gaitlab.nlp.ipopt import Ipopt
from gaitlab.nlp.problem import NLP

N, DURATION = 20, 1.0


def rest_to_rest():
    """Unit mass by 1 m in 1 s, forces constant on 20 intervals; weights (effort, peak of the force)."""
    u, theta = ca.SX.sym("u", N), ca.SX.sym("theta", 2)
    h = DURATION / N
    v = h * ca.cumsum(u)
    x = h * (ca.cumsum(v) - 0.5 * v)
    nlp = NLP(
        w=u,
        p=theta,
        f=theta[0] * h * ca.sumsqr(u),
        g=ca.vertcat(x[-1], v[-1]),
        lbw=np.full(N, -np.inf),
        ubw=np.full(N, np.inf),
        lbg=np.array([1.0, 0.0]),
        ubg=np.array([1.0, 0.0]),
    )
    return with_peak(nlp, ca.vertcat(u, -u), theta[1])


@pytest.mark.parametrize("weight", [0.6, 0.9])
def test_the_weight_of_a_peak_is_found_again(weight):
    nlp, truth = rest_to_rest(), np.array([1.0 - weight, weight])
    measured = Ipopt().solve(nlp, np.zeros(N + 1), truth)
    assert measured.is_optimal(1e-6)
    problem = InverseProblem(
        nlp=nlp,
        residual=(nlp.w[:N] - ca.DM(measured.w[:N])) / 0.1,
        free=np.ones(2, dtype=bool),
        lbp=np.array([0.01, 0.0]),
        ubp=np.ones(2),
        p_nominal=np.full(2, 0.5),
        simplex=(0, 1),
        names=("effort", "peak"),
    )
    result = GaussNewton().solve(problem, np.zeros(N + 1), np.full(2, 0.5))
    assert result.converged, result.reason
    np.testing.assert_allclose(result.p, truth, atol=1e-4)
