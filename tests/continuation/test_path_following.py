"""Paths of known shape: what is found on them, how they end, and what is said when they cannot be followed."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.continuation.extended_system import ExtendedSystem
from gaitlab.continuation.path_events import BranchPoint, Crossing, Fold, TestFunction
from gaitlab.continuation.path_following import PathFollowing, PathStatus, branch_direction, switched
from gaitlab.continuation.zero_problem import ZeroProblem
from gaitlab.errors import NotFound, ProblemError

METHOD = PathFollowing(max_points=60)


def plane(curve, start):
    """The solutions of curve(x, y) = 0 with both coordinates as parameters."""
    problem = ZeroProblem().add_variables("x", [start[0]]).add_variables("y", [start[1]])
    problem = problem.add_zero("curve", curve, "x", "y").add_parameters(("x",), "x").add_parameters(("y",), "y")
    return ExtendedSystem(problem=problem)


def circle(start=(1.0, 0.0)):
    return plane(lambda x, y: x**2 + y**2 - 1, start)


def follow(system, **options):
    return METHOD.follow(system, system.first_point(), **options)


@pytest.mark.parametrize("direction", [1, -1])
def test_points_stay_on_the_circle_and_go_round(direction):
    path = follow(circle(), direction=direction)
    angle = np.unwrap(np.arctan2(path.x[:, 1], path.x[:, 0]))
    np.testing.assert_allclose(np.hypot(*path.x.T), 1.0, atol=1e-10)
    assert np.all(direction * np.diff(angle) > 0.0)
    assert np.abs(angle[-1]) > 4 * np.pi
    assert path.status is PathStatus.POINTS


@pytest.mark.parametrize(("parameter", "where"), [("x", (1.0, 0.0)), ("y", (0.0, 1.0))])
def test_folds(parameter, where):
    start = circle((0.6, -0.8))
    path = METHOD.follow(start, start.first_point(), direction=np.array([1.0, 0.0]), events=[Fold(parameter=parameter)])
    first = path.events[0]
    np.testing.assert_allclose(first.x, where, atol=1e-12)
    assert first.is_certified(1e-10)


def test_events_come_in_order_and_stop_the_path():
    events = [Crossing(parameter="x", value=0.5), Crossing(parameter="y", value=0.9, stops=True), Fold(parameter="y")]
    path = follow(circle(), direction=np.array([0.0, 1.0]), events=events)
    assert [e.event for e in path.events] == ["x = 0.5", "y = 0.9"]
    np.testing.assert_allclose(path.events[0].x, [0.5, np.sqrt(0.75)], atol=1e-12)
    np.testing.assert_allclose(path.x[-1], [np.sqrt(1 - 0.81), 0.9], atol=1e-12)
    assert path.status is PathStatus.EVENT


def test_any_function_can_be_an_event():
    event = TestFunction(name="diagonal", function=lambda x: x[0] - x[1], stops=True)
    path = follow(circle(), events=[event])
    np.testing.assert_allclose(path.x[-1], np.full(2, np.sqrt(0.5)), atol=1e-12)


def test_starting_at_an_event_is_not_finding_it():
    path = follow(circle(), direction=np.array([0.0, 1.0]), events=[Fold(parameter="x", stops=True)])
    np.testing.assert_allclose(path.x[-1], [-1.0, 0.0], atol=1e-10)


def test_bounds_end_a_path():
    path = follow(circle(), direction=np.array([0.0, 1.0]), bounds={"x": (0.0, 2.0)})
    assert path.status is PathStatus.BOUND
    assert "'x'" in path.reason
    assert path.parameters["x"][-2] >= 0.0 > path.parameters["x"][-1]


def test_pitchfork_is_found_and_its_branch_entered():
    """y = 0 for all x, and the parabola x = y^2 that crosses it at the origin."""
    system = plane(lambda x, y: y * (x - y**2), (-1.0, 0.0))
    path = METHOD.follow(system, system.first_point(), direction=np.array([1.0, 0.0]), events=[BranchPoint(stops=True)])
    point = path.located("branch point")[0]
    np.testing.assert_allclose(point.x, 0.0, atol=1e-8)
    direction = branch_direction(system, point)
    np.testing.assert_allclose(np.abs(direction), [0.0, 1.0], atol=1e-6)
    first = switched(METHOD, point, direction, 0.2)
    branch = METHOD.follow(system, first.x, direction=direction, bounds={"x": (-1.0, 2.0)})
    np.testing.assert_allclose(branch.x[:, 0], branch.x[:, 1] ** 2, atol=1e-9)
    assert branch.parameters["x"][-1] > 2.0


def test_a_curve_that_ends_is_told():
    """y = x^1.5 ends at the origin."""
    path = follow(plane(lambda x, y: y - x**1.5, (1.0, 1.0)), direction=np.array([-1.0, 0.0]))
    assert path.status is PathStatus.STEP
    assert "'curve' returned a number that is not finite" in path.reason


def test_a_corner_is_told():
    path = follow(plane(lambda x, y: y - ca.fabs(x), (-1.0, 1.0)), direction=np.array([1.0, 0.0]))
    assert path.status is PathStatus.STEP


def test_not_finite_at_the_start():
    path = follow(plane(lambda x, y: ca.log(x) + y, (-1.0, 0.0)))
    assert path.status is PathStatus.INVALID
    assert "'curve'" in path.reason


def test_no_solution_near_the_start():
    path = follow(plane(lambda x, y: x**2 + y**2 + 1, (1.0, 0.0)))
    assert path.status is PathStatus.START
    assert "does not satisfy the equations" in path.reason


def test_dependent_equations_at_the_start():
    path = follow(plane(lambda x, y: (x - y) ** 2, (1.0, 1.0)))
    assert path.status is PathStatus.START
    assert "no full rank" in path.reason


def test_malformed_requests():
    with pytest.raises(NotFound, match="'z'"):
        follow(circle(), bounds={"z": (0.0, 1.0)})
    with pytest.raises(ProblemError, match=r"shape \(2,\)"):
        METHOD.follow(circle(), np.zeros(3))
