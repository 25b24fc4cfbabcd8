"""Bratu's problem: solutions and fold by formula, and the order of the fold."""

import numpy as np
import pytest

from gaitlab.benchmarks.bratu import CRITICAL, bratu, bratu_problem, exact_critical, exact_solution, segment
from gaitlab.continuation.collocation_mesh import Mesh
from gaitlab.continuation.extended_system import ExtendedSystem
from gaitlab.continuation.extremum import SuccessiveContinuation
from gaitlab.continuation.path_events import Crossing, Fold
from gaitlab.continuation.path_following import PathFollowing


def test_published_fold():
    assert exact_critical() == pytest.approx(CRITICAL, abs=1e-9)


def test_largest_heat_release():
    found = SuccessiveContinuation().solve(bratu())
    assert found.converged
    assert found.objective == pytest.approx(exact_critical(), abs=1e-8)


def test_both_solutions_below_the_fold():
    mesh = Mesh.uniform(10)
    problem = bratu_problem(mesh)
    events = (Crossing(parameter="q", value=3.0),)
    path = PathFollowing().follow(
        ExtendedSystem(problem=problem), problem.start, direction=_rising(problem), events=events, bounds={"q": (-1, 9)}
    )
    tops = [segment(mesh).states(problem, e.x)[:, 0] for e in path.events[:2]]
    assert tops[0].max() < tops[1].max()
    for y in tops:
        c = 2.0 * np.arccosh(np.exp(y.max() / 2.0))  # y(1/2) = 2 ln cosh(c / 2)
        exact, q = exact_solution(mesh.points, c)
        np.testing.assert_allclose(y, exact, atol=1e-6)
        assert q == pytest.approx(3.0, abs=1e-6)


def test_fold_converges_with_twice_the_degree():
    errors = []
    for n in (4, 8):
        problem = bratu_problem(Mesh.uniform(n, degree=2))
        path = PathFollowing().follow(
            ExtendedSystem(problem=problem),
            problem.start,
            direction=_rising(problem),
            events=(Fold(parameter="q", stops=True),),
        )
        errors.append(abs(path.parameters["q"][-1] - exact_critical()))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.3)


def _rising(problem):
    return ExtendedSystem(problem=problem).parameter_gradient(problem.start, "q")
