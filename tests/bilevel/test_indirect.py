"""The rocket car by Pontryagin's maximum principle, against the printed solutions of Hatz (2014), Table 6.2."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from gaitlab.benchmarks.rocket_car import rocket_car_problem
from gaitlab.bilevel.indirect import Arc, arcs_of, boundary_value_problem, hamiltonian, start_from
from gaitlab.bilevel.riccati import riccati_test
from gaitlab.errors import ProblemError
from gaitlab.ocp.constraint import Bounds
from gaitlab.ocp.measurement import Measurement
from gaitlab.ocp.problem import MultiStageProblem
from gaitlab.ocp.stage import Stage, fixed
from gaitlab.ocp.trajectory import StageTrajectory, Trajectory, straight_line
from gaitlab.transcription.collocation import DirectCollocation
from gaitlab.transcription.multiple_shooting import MultipleShooting
from gaitlab.transcription.optimal_control import Solve

SETTINGS = {
    # The adjoints of Setting 1 are printed for weights (1, 1).
    "1": ((1.0, 1.0), 5.268999, (0.3450745, 0.8673559, -1.326436), (0.3450745, -0.3375312, 1.0), 0.4918159),
    "2": ((6 / 7, 1 / 7), 5.956249, (0.07140323, 0.1883686, 0.4551155), (0.07140323, -0.09690561, 6 / 7), 0.6906386),
    "3": (
        (16 / 17, 1 / 17),
        7.536531,
        (0.03867384, 0.1322845, 0.7437162),
        (0.03867384, -0.05976373, 16 / 17),
        0.8503220,
    ),
}
PROBLEM = rocket_car_problem()
FINE = DirectCollocation(grids=1, degree=7, n_elements=8)
DIRECT = MultipleShooting(grids=20).transcribe(PROBLEM)


def parameters(weights, p1=0.1, p2=0.1):
    return PROBLEM.parameters({"mass": weights[0], "time": weights[1], "p1": p1, "p2": p2})


def direct(p):
    result = Solve()(DIRECT, straight_line(PROBLEM, np.array([5.0])), p)
    assert result.converged
    return result


@pytest.fixture(scope="module", params=SETTINGS)
def setting(request):
    weights, *printed = SETTINGS[request.param]
    p = parameters(weights)
    found = direct(p)
    arcs = arcs_of(DIRECT, found.trajectory)
    transcribed = FINE.transcribe(boundary_value_problem(PROBLEM, arcs))
    result = Solve()(transcribed, start_from(DIRECT, found.solution, p, arcs), p)
    assert result.converged, result.reason
    return p, arcs, result.trajectory, printed


def test_durations_adjoints_and_mass_are_those_printed(setting):
    _, _, trajectory, (duration, first, last, mass) = setting
    assert trajectory.q.sum() == pytest.approx(duration, abs=2e-6)
    np.testing.assert_allclose(trajectory.stages[0].x[0, 3:], first, atol=2e-6)
    np.testing.assert_allclose(trajectory.stages[-1].x[-1, 3:], last, atol=2e-6)
    assert trajectory.stages[-1].x[-1, 2] == pytest.approx(mass, abs=2e-6)


def test_the_hamiltonian_is_constant_along_the_solution(setting):
    p, arcs, trajectory, _ = setting
    principle = hamiltonian(PROBLEM)
    for arc, stage in zip(arcs, trajectory.stages, strict=True):
        value = ca.substitute(principle.value, principle.stage.u, principle.control(arc))
        states = ca.vertcat(principle.stage.x, principle.lam)
        along = ca.Function("H", [states, ca.vertcat(principle.theta, principle.p)], [value])
        np.testing.assert_allclose([float(along(y, p)) for y in stage.x], p[1], atol=1e-8)


def test_second_order_conditions_hold(setting):
    p, arcs, trajectory, _ = setting
    test = riccati_test(hamiltonian(PROBLEM), trajectory, p, arcs)
    assert test.sufficient and test.largest < 10.0, test.reason


def test_one_expression_of_the_control_finds_the_same_solution():
    p = parameters((6 / 7, 1 / 7))
    fine = MultipleShooting(grids=100).transcribe(boundary_value_problem(PROBLEM))
    found = direct(p)
    result = Solve()(fine, start_from(DIRECT, found.solution, p), p)
    assert result.trajectory.duration == pytest.approx(5.956249, abs=1e-5)


@pytest.mark.parametrize("weights", [(0.5, 0.5), (6 / 7, 1 / 7), (16 / 17, 1 / 17)])
def test_exact_measurements_give_weight_and_parameters(weights):
    problem, method, truth = boundary_value_problem(PROBLEM), MultipleShooting(grids=20), parameters(weights)
    transcribed = method.transcribe(problem)
    exact = Solve()(transcribed, start_from(DIRECT, direct(truth).solution, truth), truth).trajectory
    values = exact.stages[0].x[:, :3]
    fit = Measurement(
        name="states", function=problem.stages[0].x[:3], times=exact.stages[0].fraction, values=values,
        sd=np.full(values.shape, 0.04),
    )  # fmt: skip
    free = problem.with_free_parameters(
        Bounds(lower=np.array([0.0, weights[1], 0.01, 0.01]), upper=np.array([5.0, weights[1], 1.0, 1.0]))
    )
    guess = parameters((1.1 * weights[0], weights[1]), 0.105, 0.095)
    near = Solve()(transcribed, start_from(DIRECT, direct(guess).solution, guess), guess).trajectory
    start = replace(near, q=np.concatenate([near.q, guess]))
    result = Solve()(method.transcribe(free, fit=(fit,)), start, np.zeros(0))
    assert result.converged
    np.testing.assert_allclose(result.trajectory.q[1:], truth, atol=1e-6)


def oscillation(duration):
    """min int u^2 - x^2 dt, dx/dt = u, x = 0 at both ends: resting is a minimum until the conjugate point at pi."""
    x, u, q = ca.SX.sym("x"), ca.SX.sym("u"), ca.SX.sym("duration")
    stage = Stage(
        name="swing", x=x, u=u, ode=u, duration=q, lagrange={"energy": u**2 - x**2}, u_bounds=Bounds.symmetric(9.0),
        start=fixed(0.0), end=fixed(0.0),
    )  # fmt: skip
    rest = StageTrajectory(fraction=np.array([0.0, 1.0]), duration=duration, x=np.zeros((2, 2)), u=np.zeros((2, 0)))
    problem = MultiStageProblem(stages=(stage,), q=q, q_bounds=Bounds(lower=np.ones(1), upper=np.full(1, 9.0)))
    return hamiltonian(problem), Trajectory(stages=(rest,), q=np.array([duration]))


@pytest.mark.parametrize(("duration", "bounded"), [(2.5, True), (4.0, False)])
def test_a_conjugate_point_is_seen(duration, bounded):
    principle, rest = oscillation(duration)
    test = riccati_test(principle, rest, np.array([1.0]), (Arc.INSIDE,))
    assert test.bounded is bounded
    # The energy of resting does not depend on the duration, so sufficiency is not strict in it.
    assert not test.sufficient


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"u_bounds": None}, "one control, bounded on both sides"),
        ({"ode": PROBLEM.stages[0].ode * PROBLEM.stages[0].u ** 2}, "must be quadratic in u"),
        ({"x_bounds": Bounds.none(3)}, "boundary conditions only"),
    ],
)
def test_other_problems_are_refused(change, sentence):
    with pytest.raises(ProblemError, match=sentence):
        boundary_value_problem(replace(PROBLEM, stages=(replace(PROBLEM.stages[0], **change),)))


def test_no_arcs_are_refused():
    with pytest.raises(ProblemError, match="at least one arc"):
        boundary_value_problem(PROBLEM, ())
