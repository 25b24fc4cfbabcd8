"""Multipliers of a point, and its curvature, where both are known."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.continuation.adjoints import estimated_multipliers, held_monitors, reduced_curvature
from gaitlab.continuation.extended_system import ExtendedSystem
from gaitlab.continuation.zero_problem import ZeroProblem

KAPPA = 0.1


def paraboloid():
    """f = 2 (x - 1)^2 + 3 y^2 + z on the plane z = 1 with y <= 0.5, at the point (1, 0, 1)."""
    problem = ZeroProblem().add_variables("x", [1.0, 0.0, 1.0]).add_zero("plane", lambda x: x[2] - 1, "x")
    problem = problem.add_monitor("f", lambda x: 2 * (x[0] - 1) ** 2 + 3 * x[1] ** 2 + x[2], "x")
    return problem.add_parameters(("a", "b"), np.array([0, 1]))


def system(problem, **fixed):
    fixed = {"d.f": 1.0, "d.a": 0.0} | fixed
    return ExtendedSystem(problem=problem, fixed=fixed, adjoint=True, objective="f")


def test_multipliers_of_an_extremum():
    """The equation's multiplier balances df/dz = 1."""
    found = estimated_multipliers(system(paraboloid()), paraboloid().start)
    np.testing.assert_allclose(found, [-1.0, 1.0, 0.0, 0.0], atol=1e-12)


def test_multipliers_obey_relaxed_complementarity():
    problem = paraboloid().add_inequality("g", lambda x: x[1] - 0.5, "x")
    found = estimated_multipliers(system(problem, kappa=KAPPA), problem.start, KAPPA)
    sigma = found[problem.rows["g"].start]
    assert sigma == pytest.approx(KAPPA / 0.5)
    assert found[problem.rows["b"].start] == pytest.approx(-sigma)


def test_multipliers_that_are_not_unique():
    problem = paraboloid().add_zero("again", lambda x: 2 * x[2] - 2, "x").add_variables("w", 0.0)
    assert estimated_multipliers(system(problem), problem.start) is None


@pytest.mark.parametrize(("held", "expected"), [((), [4.0, 6.0]), (("a",), [6.0]), (("a", "b"), [])])
def test_curvature_on_what_is_free(held, expected):
    s = system(paraboloid())
    x = s.first_point(np.array([-1.0, 1.0, 0.0, 0.0]))
    np.testing.assert_allclose(reduced_curvature(s, x, "f", held), expected, atol=1e-12)


def test_curvature_of_a_curved_constraint():
    """x on the unit circle at its top: y = sqrt(1 - x^2) has the curvature -1."""
    problem = ZeroProblem().add_variables("x", [0.0, 1.0]).add_zero("circle", lambda x: ca.sumsqr(x) - 1, "x")
    problem = problem.add_monitor("f", lambda x: x[1], "x")
    s = ExtendedSystem(problem=problem, adjoint=True)
    x = s.first_point(np.array([-0.5, 1.0]))
    np.testing.assert_allclose(reduced_curvature(s, x, "f", ()), [-1.0], atol=1e-12)


def test_no_curvature_without_a_multiplier():
    s = system(paraboloid())
    assert reduced_curvature(s, s.first_point(), "f", ()) is None


def test_held_monitors():
    assert held_monitors(paraboloid(), ("f", "b")) == ("a",)
