"""Inequalities in successive continuation: active, inactive, becoming active on the way, and not satisfied."""

import numpy as np
import pytest

from gaitlab.continuation.extended_system import RELAXATION
from gaitlab.continuation.extremum import ExtremumProblem, Kind, SuccessiveContinuation
from gaitlab.continuation.zero_problem import ZeroProblem


def nearest(bound, sign=1.0, **options):
    """The point closest to (2, 1) in the half plane x + y <= bound, as a minimum or (sign -1) a maximum."""
    problem = ZeroProblem().add_variables("x", [0.0, 0.1])
    problem = problem.add_monitor("f", lambda x: sign * ((x[0] - 2) ** 2 + (x[1] - 1) ** 2), "x")
    problem = problem.add_parameters(("x1", "x2"), "x").add_inequality("limit", lambda x: x[0] + x[1] - bound, "x")
    wanted = ExtremumProblem(problem=problem, objective="f", parameters=("x1", "x2"), maximise=sign < 0.0, **options)
    return SuccessiveContinuation().solve(wanted)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("bound", [0.5, 2.0, 2.9])
def test_active(bound, sign):
    found = nearest(bound, sign)
    violation = (3.0 - bound) / 2.0
    assert found.converged, found.reason
    np.testing.assert_allclose(found.x[:2], [2.0 - violation, 1.0 - violation], atol=1e-8)
    assert found.system.parameter(found.x, "d.limit") == pytest.approx(2.0 * violation, abs=1e-7)
    assert found.system.parameter(found.x, RELAXATION) == pytest.approx(0.0, abs=1e-10)
    assert found.kind is (Kind.MINIMUM if sign > 0.0 else Kind.MAXIMUM)


def test_inactive():
    found = nearest(5.0)
    assert found.converged
    np.testing.assert_allclose(found.x[:2], [2.0, 1.0], atol=1e-9)
    assert found.system.parameter(found.x, "d.limit") == pytest.approx(0.0, abs=1e-9)


def test_before_tightening_the_optimum_is_that_of_the_barrier():
    """-sigma G = kappa along the whole way."""
    relaxed = nearest(2.0, relaxation=0.05).stages[-2].point
    system, x = relaxed.system, relaxed.x
    assert -system.parameter(x, "d.limit") * (x[0] + x[1] - 2.0) == pytest.approx(0.05, abs=1e-10)


def test_an_infeasible_start_is_moved_inside_first():
    found = nearest(-1.0)
    assert found.converged, found.reason
    np.testing.assert_allclose(found.x[:2], [0.0, -1.0], atol=1e-8)


def test_no_feasible_solution_on_the_path():
    problem = ZeroProblem().add_variables("x", [0.0, 0.1]).add_monitor("f", lambda x: x[0] ** 2 + x[1] ** 2, "x")
    problem = problem.add_parameters(("x1", "x2"), "x").add_inequality("limit", lambda x: 1 + x[0] ** 2, "x")
    wanted = ExtremumProblem(
        problem=problem, objective="f", parameters=("x1", "x2"), bounds={"x1": (-2.0, 2.0), "x2": (-2.0, 2.0)}
    )
    found = SuccessiveContinuation().solve(wanted)
    assert not found.converged
    assert "violates the inequality 'limit' by 1, and so does its path: 'x1' reached its bound" in found.reason
