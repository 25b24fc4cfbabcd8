"""Events as numbers: zero at the point looked for, of one sign on each side."""

import numpy as np
import pytest

from gaitlab.continuation.extended_system import ExtendedSystem
from gaitlab.continuation.path_events import BranchPoint, Crossing, Fold, PathPoint, TestFunction
from gaitlab.continuation.zero_problem import ZeroProblem


def parabola():
    """The curve y = x^2: y has a fold at the origin."""
    problem = ZeroProblem().add_variables("x", [0.0, 0.0]).add_zero("curve", lambda x: x[1] - x[0] ** 2, "x")
    return ExtendedSystem(problem=problem.add_parameters(("x", "y"), "x"))


def point(x):
    tangent = np.array([1.0, 2.0 * x])
    return PathPoint(x=np.array([x, x**2]), tangent=tangent / np.linalg.norm(tangent))


@pytest.mark.parametrize(
    ("event", "name", "where"),
    [
        (Crossing(parameter="x", value=0.5), "x = 0.5", 0.5),
        (Crossing(parameter="y", value=0.25), "y = 0.25", 0.5),
        (Fold(parameter="y"), "fold of y", 0.0),
        (TestFunction(name="own", function=lambda x: x[0] + x[1] - 2.0), "own", 1.0),
    ],
)
def test_sign_changes_at_the_event(event, name, where):
    system = parabola()
    assert event.name == name
    assert event.test(system, point(where)) == pytest.approx(0.0, abs=1e-15)
    assert event.test(system, point(where - 0.1)) * event.test(system, point(where + 0.1)) < 0.0
    assert event.measure(system, point(where))(system, point(0.3)) == event.test(system, point(0.3))


def crossing_lines():
    """The lines y = 0 and x = 0."""
    problem = ZeroProblem().add_variables("x", [0.0, 0.0]).add_zero("lines", lambda x: x[0] * x[1], "x")
    return ExtendedSystem(problem=problem)


def on_the_line(x):
    return PathPoint(x=np.array([x, 0.0]), tangent=np.array([1.0, 0.0]))


def test_branch_point_is_measured_smoothly():
    event, system = BranchPoint(), crossing_lines()
    measure = event.measure(system, on_the_line(0.1))
    left, right = measure(system, on_the_line(-0.01)), measure(system, on_the_line(0.02))
    assert event.test(system, on_the_line(-0.01)) * event.test(system, on_the_line(0.02)) < 0.0
    assert left / right == pytest.approx(-0.5, rel=1e-6)
