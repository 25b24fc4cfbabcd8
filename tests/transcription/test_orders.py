"""Convergence of whole transcriptions with their order, on problems with closed solutions."""

import numpy as np
import pytest
from chain_problems import doubling_jump, regulator, shortest_time

from gaitlab.nlp.ipopt import Ipopt
from gaitlab.ocp.constraint import Constraint, PointConstraint
from gaitlab.ocp.trajectory import straight_line
from gaitlab.transcription.collocation import DirectCollocation
from gaitlab.transcription.control_shapes import CONSTANT, CUBIC, LINEAR
from gaitlab.transcription.integrators import RadauIIA, RungeKutta4
from gaitlab.transcription.multiple_shooting import MultipleShooting
from gaitlab.transcription.optimal_control import Solve

SOLVE = Solve(solver=Ipopt(tol=1e-12))
EXACT = [
    MultipleShooting(grids=10),
    MultipleShooting(grids=10, integrator=RadauIIA()),
    DirectCollocation(grids=10),
    DirectCollocation(grids=10, points="legendre"),
]


def solved(problem, method, p=(), q=()):
    transcribed = method.transcribe(problem)
    result = SOLVE(transcribed, straight_line(problem, np.array(q)), np.array(p, dtype=float))
    assert result.converged, result.reason
    return result


@pytest.mark.parametrize(("shape", "order", "near"), [(CONSTANT, 2, 0.2), (LINEAR, 4, 0.2), (CUBIC, 8, 1.0)])
def test_the_cost_converges_with_twice_the_order_of_the_controls(shape, order, near):
    problem = regulator(duration=6.0)

    def error(n):
        method = DirectCollocation(grids=n, points="legendre", degree=6, n_elements=2, control=shape)
        return abs(solved(problem, method, p=(1.0, 1.0)).solution.f - np.tanh(6.0))

    assert np.log2(error(6) / error(12)) == pytest.approx(order, abs=near)


@pytest.mark.parametrize(
    ("make", "order"),
    [
        (lambda n: MultipleShooting(grids=1, integrator=RungeKutta4(n_steps=n), control=CUBIC), 4),
        (lambda n: MultipleShooting(grids=1, integrator=RadauIIA(n_steps=n), control=CUBIC), 3),
        (lambda n: DirectCollocation(grids=1, degree=2, n_elements=n, control=CUBIC), 3),
        (lambda n: DirectCollocation(grids=1, degree=2, n_elements=n, points="legendre", control=CUBIC), 4),
    ],
    ids=["runge-kutta", "implicit", "radau", "legendre"],
)
def test_the_dynamics_converge_with_the_order_of_the_scheme(make, order):
    problem = regulator()
    limit = solved(problem, DirectCollocation(grids=1, degree=9, control=CUBIC), p=(1.0, 1.0)).solution.f
    errors = [abs(solved(problem, make(n), p=(1.0, 1.0)).solution.f - limit) for n in (4, 8)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)


@pytest.mark.parametrize("method", EXACT)
def test_a_free_duration_is_found(method):
    result = solved(shortest_time(), method, p=(1.0,), q=(1.0,))
    assert result.trajectory.duration == pytest.approx(2.0, abs=1e-7)


@pytest.mark.parametrize("method", EXACT)
def test_a_path_constraint_holds_and_costs(method):
    result = solved(shortest_time(speed_limit=0.5), method, p=(1.0,), q=(1.0,))
    assert result.trajectory.duration == pytest.approx(2.5, abs=1e-6)
    assert result.trajectory.stages[0].x[:, 1].max() < 0.5 + 1e-7


@pytest.mark.parametrize("method", EXACT)
def test_stages_are_joined_by_jumps(method):
    result = solved(doubling_jump(), method, p=(1.0,))
    assert result.solution.f == pytest.approx(0.2, abs=1e-8)
    before, after = result.trajectory.stages
    assert after.x[0, 0] == pytest.approx(2 * before.x[-1, 0], abs=1e-9)
    np.testing.assert_allclose(before.u, 0.4, atol=1e-6)


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize(("time", "expected"), [(0.4, 1 / 0.4 + 1 / 0.6), (1.0, 1.0)])
def test_a_constraint_between_points_of_time_holds(method, time, expected):
    problem = regulator()
    start, later = problem.point(0.0), problem.point(time)
    rise = Constraint(name="rise", expression=later.x - start.x, lower=np.ones(1), upper=np.ones(1))
    problem = problem.with_points(PointConstraint(points=(start, later), constraint=rise))
    if time < 1.0:
        end, first = problem.point(1.0), problem.point(0.0)
        closed = Constraint(name="closed", expression=end.x - first.x, lower=np.zeros(1), upper=np.zeros(1))
        problem = problem.with_points(PointConstraint(points=(first, end), constraint=closed))
    result = solved(problem, method, p=(0.0, 1.0))
    assert result.solution.f == pytest.approx(expected, abs=1e-7)


def test_a_constraint_between_nodes_holds_where_it_is_imposed():
    problem = regulator()
    point = problem.point(0.333)
    rule = Constraint(name="pass", expression=point.x, lower=np.full(1, 0.2), upper=np.full(1, 0.2))
    problem = problem.with_points(PointConstraint(points=(point,), constraint=rule))
    for method in EXACT:
        stage = solved(problem, method, p=(1.0, 1.0)).trajectory.stages[0]
        # States are linear between nodes for constant controls.
        assert stage.state_at(np.array([0.333]))[0, 0] == pytest.approx(0.2, abs=1e-8)


def test_cubic_controls_obey_their_bounds_everywhere():
    problem = shortest_time()
    method = DirectCollocation(grids=6, degree=5, control=CUBIC)
    transcribed = method.transcribe(problem)
    result = SOLVE(transcribed, straight_line(problem, np.array([2.0])), np.array([1.0]))
    fine = transcribed.trajectory(result.solution.w, np.array([1.0]), per_interval=20).stages[0]
    assert result.converged and np.abs(fine.u).max() < 1.0 + 1e-7
    assert 2.0 < fine.duration < 2.6
