import casadi as ca
import numpy as np
import pytest
from inverse_toys import INF, clipped, inverse, program

from gaitlab.bilevel.lower_level import LowerLevel


def curved():
    """A lower level with an equation, an active and an inactive inequality, a bound, all curved in (w, p)."""
    w, p = ca.SX.sym("w", 4), ca.SX.sym("p", 2)
    f = ca.sumsqr(w - ca.vertcat(p[0], p[1], p[0] * p[1], 2.0)) + 0.1 * w[0] ** 4
    g = [w[0] * w[1] + w[2] - p[1], w[2] ** 2 + w[3] ** 2 - 1.0 - p[0], w[0] - 10.0]
    nlp = program(w, p, f, g, lbg=[0.0, -INF, -INF], ubg=[0.0, 0.0, 0.0], lbw=[-INF, 0.9, -INF, -INF])
    residual = ca.vertcat(ca.sin(w), w[0] * p[1])
    return inverse(nlp, residual, upper=ca.SX(w[3] * p[0]), lbu=np.zeros(1), ubu=np.ones(1))


P = np.array([0.7, 0.4])


@pytest.fixture
def level():
    return LowerLevel(curved())


def test_slopes_against_finite_differences(level):
    response = level.start(np.ones(4), P)
    slopes = level.slopes(response)
    assert response.solution.lam_g[1] > 0.1 and response.solution.lam_w[1] < -0.1  # both are active
    h = 1e-6
    for k in range(2):
        ends = [level.respond(P + sign * h * np.eye(2)[k], response) for sign in (1.0, -1.0)]
        for name in ("residual", "upper"):
            difference = (getattr(ends[0], name) - getattr(ends[1], name)) / (2 * h)
            np.testing.assert_allclose(getattr(slopes, name)[:, k], difference, atol=1e-6)
        for name in ("w", "lam_w", "lam_g"):
            difference = (getattr(ends[0].solution, name) - getattr(ends[1].solution, name)) / (2 * h)
            np.testing.assert_allclose(getattr(slopes, name)[:, k], difference, atol=1e-5)


def test_nearby_solutions_cost_a_few_newton_steps(level):
    response = level.start(np.ones(4), P)
    level.iterations = 0
    moved = level.respond(P + 0.02, response, level.slopes(response))
    assert moved.solved and moved.solution.residuals.max() < 1e-9
    assert level.iterations <= 4


def test_a_changed_active_set_is_found():
    level = LowerLevel(clipped())
    inside = level.start(np.zeros(2), np.array([0.4]))
    outside = level.respond(np.array([1.7]), inside, level.slopes(inside))
    np.testing.assert_allclose(outside.solution.w, [1.0, 3.4], atol=1e-8)
    assert outside.solution.lam_w[0] == pytest.approx(1.4, abs=1e-7)


def test_active_constraints_that_repeat_each_other_have_derivatives_all_the_same():
    w, p = ca.SX.sym("w", 2), ca.SX.sym("p")
    nlp = program(w, p, ca.sumsqr(w), [w[0] + w[1] - p, 2 * w[0] + 2 * w[1] - 2 * p], lbg=[0, 0], ubg=[0, 0])
    level = LowerLevel(inverse(nlp, w))
    response = level.start(np.zeros(2), np.array([3.0]))
    np.testing.assert_allclose(level.slopes(response).w.ravel(), [0.5, 0.5], atol=1e-7)
    assert level.not_a_minimum(response) is None


def test_a_saddle_is_told_from_a_minimum():
    w, p = ca.SX.sym("w", 3), ca.SX.sym("p")
    level = LowerLevel(inverse(program(w, p, w[0] ** 2 - (w[1] - p) ** 2 + w[2] ** 2), w))
    saddle = level.start(np.array([0.0, 1.0, 0.0]), np.ones(1))
    assert "w[1]" in level.not_a_minimum(saddle)
