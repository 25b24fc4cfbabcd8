import casadi as ca
import numpy as np
import pytest
from inverse_toys import inverse, program, unidentifiable, weighted_mean

from gaitlab.bilevel.gauss_newton import GaussNewton
from gaitlab.bilevel.profile_likelihood import ProfileLikelihood
from gaitlab.errors import ProblemError


def estimate(problem):
    return GaussNewton().solve(problem, np.zeros(problem.nlp.w.numel()), problem.p_nominal)


def straight_line():
    """Intercept and slope of a line through three noisy points: linear, so the profile is a parabola."""
    w, p = ca.SX.sym("w", 3), ca.SX.sym("p", 2)
    t = ca.DM([0.0, 1.0, 2.0])
    return inverse(program(w, p, ca.sumsqr(w - p[0] - p[1] * t)), (w - ca.DM([1.0, 2.2, 2.9])) / 0.5)


@pytest.mark.parametrize("index", [0, 1])
def test_a_linear_problem_has_the_interval_of_its_covariance(index):
    problem = straight_line()
    result = estimate(problem)
    profile = ProfileLikelihood(first_step=0.01, growth=1.1, max_steps=60).run(problem, result, index)
    half = 1.959964 * np.sqrt(result.covariance[index, index])
    assert profile.identifiable
    assert profile.lower == pytest.approx(result.p[index] - half, abs=0.01)
    assert profile.upper == pytest.approx(result.p[index] + half, abs=0.01)


def test_an_unidentifiable_parameter_has_no_ends():
    problem = unidentifiable()
    profile = ProfileLikelihood(max_steps=4).run(problem, estimate(problem), 0)
    assert not profile.identifiable
    np.testing.assert_allclose(profile.objective, 0.0, atol=1e-8)


def test_a_weight_moves_along_the_simplex():
    problem = weighted_mean()
    profile = ProfileLikelihood().run(problem, estimate(problem), 1)
    assert profile.identifiable
    assert profile.lower < 0.3 < profile.upper


def test_a_fixed_parameter_has_no_profile():
    problem = straight_line()
    with pytest.raises(ProblemError, match="not among the estimated"):
        ProfileLikelihood().run(problem, estimate(problem), 2)
