"""Successive continuation where the answer is known, and where there is none."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.continuation.extremum import ExtremumProblem, Kind, SuccessiveContinuation
from gaitlab.continuation.zero_problem import ZeroProblem
from gaitlab.errors import ProblemError

METHOD = SuccessiveContinuation()


def unconstrained(f, start, **options):
    """Extremum of f over the plane."""
    problem = ZeroProblem().add_variables("x", start).add_monitor("f", f, "x").add_parameters(("a", "b"), "x")
    return ExtremumProblem(**({"problem": problem, "objective": "f", "parameters": ("a", "b")} | options))


def ellipse(c):
    """Points with x^2 + 2 y^2 = c^2; c is a monitor that is held."""
    problem = ZeroProblem().add_variables("x", [c, 0.0]).add_variables("c", c)
    problem = problem.add_zero("ellipse", lambda x, c: x[0] ** 2 + 2 * x[1] ** 2 - c**2, "x", "c")
    problem = problem.add_monitor("sum", lambda x: ca.sum1(x), "x").add_parameters(("c",), "c")
    return ExtremumProblem(problem=problem, objective="sum", parameters=(), maximise=True)


@pytest.mark.parametrize(
    ("f", "kind"),
    [
        (lambda x: (x[0] - 1) ** 2 + (x[1] + 1) ** 2 + x[0] * x[1], Kind.MINIMUM),
        (lambda x: -((x[0] - 1) ** 2) - (x[1] + 1) ** 2 + x[0] * x[1], Kind.MAXIMUM),
        (lambda x: (x[0] - 1) ** 2 - (x[1] + 1) ** 2 + x[0] * x[1], Kind.SADDLE),
    ],
)
@pytest.mark.parametrize("maximise", [False, True])
def test_stationary_points_and_their_kind(f, kind, maximise):
    found = METHOD.solve(unconstrained(f, [0.0, 0.0], maximise=maximise))
    x = ca.SX.sym("x", 2)
    gradient = ca.Function("g", [x], [ca.gradient(f(x), x)])(found.x[:2])
    assert found.converged, found.reason
    np.testing.assert_allclose(np.asarray(gradient), 0.0, atol=1e-9)
    assert found.kind is kind


def test_stages_are_partial_extrema():
    found = METHOD.solve(unconstrained(lambda x: (x[0] - 1) ** 2 + (x[1] + 1) ** 2 + x[0] * x[1], [0.0, 0.0]))
    fold, switched, last = found.stages
    np.testing.assert_allclose(fold.point.x[:2], [1.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(switched.point.x[:3], [1.0, 0.0, 1.0], atol=1e-9)
    assert last.objective < switched.objective == pytest.approx(fold.objective)
    assert all(stage.point.is_certified(1e-8) for stage in found.stages)


def test_curvature_is_that_of_the_hessian():
    found = METHOD.solve(unconstrained(lambda x: 3 * (x[0] - 1) ** 2 + 0.5 * x[1] ** 2, [0.0, 0.4]))
    np.testing.assert_allclose(found.curvature, [1.0, 6.0], rtol=1e-9)


def test_multiplier_is_the_derivative_of_the_optimum():
    """The largest x + y on the ellipse is c sqrt(3 / 2)."""
    found = METHOD.solve(ellipse(2.0))
    assert found.objective == pytest.approx(2.0 * np.sqrt(1.5), abs=1e-9)
    assert found.multipliers["c"] == pytest.approx(np.sqrt(1.5), abs=1e-8)


def test_starting_at_an_extremum_of_a_later_parameter():
    found = METHOD.solve(unconstrained(lambda x: (x[0] - 1) ** 2 + x[1] ** 2, [0.0, 0.0]))
    assert found.converged
    np.testing.assert_allclose(found.x[:2], [1.0, 0.0], atol=1e-9)


def test_unbounded_objectives_have_no_fold():
    found = METHOD.solve(unconstrained(lambda x: x[0] + x[1] ** 2, [0.0, 0.0], bounds={"a": (-5.0, 5.0)}))
    assert not found.converged
    assert "no fold of 'f' was found: 'a' reached its bound" in found.reason


def test_unbounded_in_a_later_parameter():
    found = METHOD.solve(unconstrained(lambda x: (x[0] - 1) ** 2 + x[1], [0.0, 0.0], bounds={"b": (-5.0, 5.0)}))
    assert not found.converged
    assert found.reason.startswith("d.b does not vanish")
    assert len(found.stages) == 2


def test_degenerate_minimum_is_not_called_one():
    found = METHOD.solve(unconstrained(lambda x: (x[0] - 1) ** 2 + (x[0] - 1 - x[1]) ** 2, [0.0, 0.5]))
    assert found.kind is Kind.MINIMUM
    flat = METHOD.solve(unconstrained(lambda x: (x[0] - 1) ** 2 + 0.0 * x[1], [0.0, 0.5]))
    assert flat.kind is Kind.UNKNOWN


def test_not_finite_at_the_start():
    found = METHOD.solve(unconstrained(lambda x: ca.log(x[0]) + x[1] ** 2, [-1.0, 0.0]))
    assert not found.converged
    assert "'f' returned a number that is not finite" in found.reason


def test_dependent_equations():
    problem = ZeroProblem().add_variables("x", [1.0, 0.0, 0.0])
    for name in ("one", "again"):
        problem = problem.add_zero(name, lambda x: x[0] - 1, "x")
    problem = problem.add_monitor("f", lambda x: x[1], "x")
    found = METHOD.solve(ExtremumProblem(problem=problem, objective="f", parameters=()))
    assert not found.converged
    assert "full rank" in found.reason


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"objective": "g"}, "'g' is no monitor"),
        ({"parameters": ("a", "a")}, "each parameter once"),
        ({"parameters": ("a", "f")}, "not the objective"),
        ({"parameters": ()}, "monitors cannot make a path"),
    ],
)
def test_malformed_problems(options, message):
    with pytest.raises(ProblemError, match=message):
        unconstrained(lambda x: ca.sumsqr(x), [0.0, 0.0], **options)
