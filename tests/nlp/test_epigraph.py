"""The peak as a criterion of a lower level."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.nlp.epigraph import with_peak
from gaitlab.nlp.ipopt import Ipopt
from gaitlab.nlp.problem import NLP


def effort(n=6):
    """Least effort to shift something by one with n forces of unequal leverage; p weighs a peak of the force."""
    w, p = ca.SX.sym("w", n), ca.SX.sym("p")
    leverage = np.linspace(0.5, 1.5, n)
    nlp = NLP(
        w=w,
        p=p,
        f=0.5 * ca.sumsqr(w),
        g=ca.dot(leverage, w),
        lbw=np.full(n, -np.inf),
        ubw=np.full(n, np.inf),
        lbg=np.ones(1),
        ubg=np.ones(1),
    )
    return with_peak(nlp, ca.vertcat(w, -w), p), leverage


def test_without_weight_nothing_changes():
    nlp, leverage = effort()
    w = Ipopt().solve(nlp, np.zeros(7), np.array([1e-9])).w[:6]
    np.testing.assert_allclose(w, leverage / (leverage @ leverage), atol=1e-6)


def test_a_heavy_peak_spreads_the_load_evenly():
    nlp, leverage = effort()
    solution = Ipopt().solve(nlp, np.zeros(7), np.array([1e2]))
    assert solution.is_optimal(1e-5)
    np.testing.assert_allclose(solution.w, 1.0 / leverage.sum(), atol=1e-6)


def test_malformed():
    nlp, _ = effort()
    with pytest.raises(ProblemError, match="outputs"):
        with_peak(nlp, ca.SX(0, 1), ca.SX(1))
    with pytest.raises(ProblemError, match="scalar"):
        with_peak(nlp, nlp.w, nlp.w)
