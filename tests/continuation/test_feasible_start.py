"""Entering the feasible set along a path."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.continuation.feasible_start import feasible_start, worst_inequality
from gaitlab.continuation.path_following import PathFollowing
from gaitlab.continuation.zero_problem import ZeroProblem


def circle(angle, **limits):
    """The unit circle with bounds on coordinates."""
    problem = ZeroProblem().add_variables("x", [np.cos(angle), np.sin(angle)])
    problem = problem.add_zero("circle", lambda x: ca.sumsqr(x) - 1, "x")
    for name, (index, bound) in limits.items():
        problem = problem.add_inequality(name, lambda x, i=index, b=bound: x[i] - b, "x")
    return problem


@pytest.mark.parametrize("angle", [0.2, -0.2, 1.0])
def test_the_start_moves_along_the_solutions(angle):
    start = feasible_start(PathFollowing(), circle(angle, right=(0, -0.2), top=(1, 0.9)), {}, {})
    assert start.found
    assert worst_inequality(start.problem, start.problem.start)[1] < -1e-3
    assert np.hypot(*start.problem.start) == pytest.approx(1.0, abs=1e-9)


def test_a_feasible_start_stays():
    problem = circle(2.0, right=(0, 0.5))
    assert feasible_start(PathFollowing(), problem, {}, {}).problem is problem


def test_no_inequalities():
    assert worst_inequality(circle(0.0), np.zeros(2)) == ("", -np.inf)


def test_contradicting_inequalities():
    start = feasible_start(PathFollowing(max_points=50), circle(0.0, right=(0, -0.9), top=(1, -0.9)), {}, {})
    assert not start.found
    assert "violates the inequality 'right' by 1.9, and so does its path" in start.reason
