"""Every method on every small inverse problem."""

import numpy as np
import pytest
from inverse_toys import (
    WEIGHTS,
    clipped,
    infeasible,
    not_a_number,
    out_of_reach,
    rank_deficient,
    unbounded,
    unidentifiable,
    weighted_mean,
)

from gaitlab.bilevel.bundle import Bundle
from gaitlab.bilevel.derivative_free import DerivativeFree
from gaitlab.bilevel.gauss_newton import GaussNewton
from gaitlab.bilevel.inverse_multi_start import InverseMultiStart
from gaitlab.bilevel.inverse_result import InverseStatus
from gaitlab.bilevel.kkt_reformulation import KKTReformulation
from gaitlab.errors import ProblemError
from gaitlab.nlp.complementarity.lifting import LiftingL1, LiftingL2
from gaitlab.nlp.complementarity.penalty import Penalty
from gaitlab.nlp.complementarity.relaxation import Relaxation
from gaitlab.nlp.complementarity.unlifted import Unlifted
from gaitlab.nlp.uno import Uno

TREATMENTS = {"unlifted": Unlifted, "l1": LiftingL1, "l2": LiftingL2, "penalty": Penalty, "relaxation": Relaxation}
METHODS = {
    "gauss-newton": GaussNewton(),
    "derivative-free": DerivativeFree(),
    "bundle": Bundle(tol=1e-12, tol_gradient=1e-7),
    "multi-start": InverseMultiStart(method=GaussNewton(), n_starts=2),
    **{f"{name}-ipopt": KKTReformulation(method=treatment()) for name, treatment in TREATMENTS.items()},
    "relaxation-ipopt-gauss-newton": KKTReformulation(method=Relaxation(), gauss_newton=True),
    "l1-filtersqp": KKTReformulation(method=LiftingL1(solver=Uno(seconds=5.0))),
}


def solve(method, problem, w0=None):
    return METHODS[method].solve(problem, np.zeros(problem.nlp.w.numel()) if w0 is None else w0, problem.p_nominal)


@pytest.mark.parametrize("method", METHODS)
def test_an_active_bound_of_the_lower_level(method):
    result = solve(method, clipped())
    assert result.is_certified(1e-6)
    np.testing.assert_allclose(result.p, [1.3], atol=1e-4)
    np.testing.assert_allclose(result.w, [1.0, 2.6], atol=1e-4)
    assert result.lam_w[0] == pytest.approx(0.6, abs=1e-3)  # 2 (p - 1) pushes against the upper bound.
    # Of both residuals only w_1 = 2 p moves with p, with unit variance.
    np.testing.assert_allclose(result.covariance, [[0.25]], rtol=1e-4)


@pytest.mark.parametrize("method", METHODS)
def test_weights_on_the_simplex(method):
    result = solve(method, weighted_mean())
    assert result.is_certified(1e-6)
    np.testing.assert_allclose(result.p, WEIGHTS, atol=2e-4)
    assert result.p.sum() == pytest.approx(1.0, abs=1e-7)
    assert np.all(result.identifiable)
    # w = (theta_1 + 4 theta_2, 2 theta_1 + 2 theta_2), sd 0.1: theta_1 = 2 w_1 / 3 - w_0 / 3, and so on.
    inverse = np.array([[-1.0, 2.0], [1.0, -0.5]]) / 3.0
    np.testing.assert_allclose(result.covariance[1:, 1:], 0.01 * inverse @ inverse.T, rtol=1e-3)


@pytest.mark.parametrize("method", METHODS)
def test_what_the_data_do_not_tell_is_named(method):
    result = solve(method, unidentifiable())
    assert result.p[0] * result.p[1] == pytest.approx(6.0, abs=1e-3)
    assert not result.identifiable.any()
    assert np.all(np.isinf(np.diag(result.covariance)))
    assert "stiffness, length" in result.reason


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("problem", "status", "word"),
    [
        (infeasible(), InverseStatus.LOWER_LEVEL_FAILED, "g["),
        (unbounded(), InverseStatus.LOWER_LEVEL_FAILED, "w[0]"),
        (not_a_number(), InverseStatus.INVALID_NUMBER, "g[0]"),
    ],
    ids=["infeasible", "unbounded", "nan"],
)
def test_a_lower_level_without_a_solution_is_named(method, problem, status, word):
    result = solve(method, problem)
    assert result.status is status
    assert word in result.reason


@pytest.mark.parametrize("method", METHODS)
def test_a_lower_level_that_does_not_determine_its_solution_is_no_success(method):
    result = solve(method, rank_deficient())
    assert result.status is InverseStatus.LOWER_LEVEL_FAILED
    assert "not curved along w[" in result.reason


@pytest.mark.parametrize("method", METHODS)
def test_upper_level_constraints_out_of_reach_are_named(method):
    result = solve(method, out_of_reach())
    assert result.status is InverseStatus.INFEASIBLE
    assert "misses its bounds" in result.reason


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("w0", "p0", "sentence"),
    [
        (np.zeros(3), np.zeros(1), r"w0 must have shape \(2,\)"),
        (np.array([0.0, np.nan]), np.zeros(1), r"w0\[1\] is nan"),
        (np.zeros(2), np.zeros(2), r"p0 must have shape \(1,\)"),
        (np.zeros(2), np.array([np.inf]), r"p0 of p\[0\] is inf"),
    ],
)
def test_starts_of_wrong_shape_or_without_numbers_are_refused(method, w0, p0, sentence):
    with pytest.raises(ProblemError, match=sentence):
        METHODS[method].solve(clipped(), w0, p0)


@pytest.mark.parametrize("method", [GaussNewton, DerivativeFree, Bundle])
def test_limits_of_time_and_iterations_are_results(method):
    """The first checks of the clock come after the first step."""
    problem = weighted_mean()
    late = method(seconds=0.0).solve(problem, np.zeros(2), problem.p_nominal)
    assert late.status is InverseStatus.TIME_LIMIT
    few = {"max_evaluations": 4} if method is DerivativeFree else {"max_iter": 1}
    assert method(**few).solve(problem, np.zeros(2), problem.p_nominal).status is InverseStatus.ITERATION_LIMIT
