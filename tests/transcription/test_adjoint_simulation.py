"""Extremal values and their derivatives against finite differences and against another integrator."""

import casadi as ca
import numpy as np
import pytest
from finite_differences import jacobian_by_differences
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from gaitlab.benchmarks.one_mass_oscillator import one_mass_oscillator
from gaitlab.benchmarks.two_axis_robot import two_axis_robot
from gaitlab.errors import ProblemError
from gaitlab.ocp.extremal import ExtremalProblem
from gaitlab.transcription.adjoint_simulation import AdjointSimulation
from gaitlab.transcription.control_spline import ControlSpline


def everything():
    """Outputs of state, control and time, dynamics of time, so that no term can hide."""
    x, u, t = ca.SX.sym("x", 2), ca.SX.sym("u", 2), ca.SX.sym("t")
    return ExtremalProblem(
        x=x,
        u=u,
        t=t,
        dynamics=ca.vertcat(x[1] + 0.1 * ca.sin(t) * u[1], u[0] - ca.sin(x[0]) - 0.2 * x[1] * u[1]),
        outputs=ca.vertcat(x[1] * u[0] + ca.cos(3 * t), x[0] ** 2 + 0.3 * u[1] * t),
        terminal=ca.vertcat(x[0] * x[1] - 0.2),
        x0=np.array([0.2, -0.1]),
        duration=2.0,
        lower=np.full(2, -3.0),
        upper=np.full(2, 3.0),
    )


PROBLEMS = (one_mass_oscillator, two_axis_robot, everything)


@pytest.fixture(params=PROBLEMS, scope="module")
def simulated(request):
    simulation = AdjointSimulation(problem=request.param(), spline=ControlSpline(n_nodes=8), steps_per_node=6)
    w = np.random.default_rng(0).uniform(-1.0, 1.0, simulation.lbw.shape)
    return simulation, w, simulation.evaluate(w)


def relative(error, of):
    return np.abs(error).max() / np.abs(of).max()


def test_adjoint_gradients(simulated):
    simulation, w, point = simulated
    truth = jacobian_by_differences(lambda w: simulation.evaluate(w).values, w)
    assert relative(point.gradients - truth, truth) < 1e-6


def test_adjoint_jacobian_of_the_final_constraints(simulated):
    simulation, w, point = simulated
    truth = jacobian_by_differences(lambda w: simulation.evaluate(w).equality, w)
    assert relative(point.equality_jacobian - truth, truth) < 1e-6


def test_hessian_of_the_lagrangian(simulated):
    simulation, w, point = simulated
    generator = np.random.default_rng(1)
    mu, lam = generator.uniform(0, 1, point.values.shape), generator.normal(size=point.equality.shape)

    def gradient(w):
        near = simulation.evaluate(w)
        return mu @ near.gradients + lam @ near.equality_jacobian

    truth = jacobian_by_differences(gradient, w)
    assert relative(point.hessian(mu, lam) - truth, truth) < 1e-6


def test_peaks_are_stationary_or_at_the_ends(simulated):
    simulation, _, point = simulated
    peaks = point.peaks
    inside = peaks.is_peak & (peaks.times > 0.0) & (peaks.times < simulation.problem.duration)
    assert inside.any()
    assert np.all(peaks.inverse_curvatures[inside] < 0.0)
    assert np.all(peaks.inverse_curvatures[~inside] == 0.0)


def test_no_guard_exceeds_the_peaks(simulated):
    _, _, point = simulated
    assert point.values[~point.is_peak].max() <= point.values[point.is_peak].max() + 1e-12


def dense_output(problem, spline, w):
    """Independent simulation with tight tolerances."""
    f = ca.Function("f", [problem.x, problem.u, problem.t], [problem.dynamics])
    h = ca.Function("h", [problem.x, problem.u, problem.t], [problem.outputs])

    def control(t):
        return spline.matrix(problem.duration, problem.u.numel(), np.array([t]))[0] @ w

    span = (0.0, problem.duration)
    path = solve_ivp(
        lambda t, x: f(x, control(t), t).full().ravel(),
        span,
        problem.x0,
        "DOP853",
        dense_output=True,
        rtol=1e-10,
        atol=1e-12,
    )
    return lambda t: h(path.sol(t), control(t), t).full().ravel()


def test_extremal_values_against_another_integrator():
    simulation = AdjointSimulation(problem=two_axis_robot(), steps_per_node=20)
    w = np.random.default_rng(2).uniform(-1.0, 1.0, simulation.lbw.shape)
    point, h = simulation.evaluate(w), dense_output(simulation.problem, simulation.spline, w)
    inside = point.is_peak & (point.peaks.inverse_curvatures < 0.0)
    peak = int(np.argmax(np.where(inside, point.values, -np.inf)))
    found = point.peaks.times[peak]
    truth = minimize_scalar(lambda t: -h(t)[0], bounds=(found - 0.05, found + 0.05), method="bounded")
    assert point.values[peak] == pytest.approx(-truth.fun, rel=1e-6)


def test_extremal_values_converge_with_the_order_of_the_integrator():
    """Fourth order: halving the step divides the error by 16."""
    spline, w = ControlSpline(n_nodes=6), np.random.default_rng(3).uniform(-1.0, 1.0, 12)
    largest = [
        AdjointSimulation(problem=two_axis_robot(), spline=spline, steps_per_node=n).evaluate(w).values.max()
        for n in (4, 8, 16, 64)
    ]
    errors = np.abs(np.array(largest[:3]) - largest[3])
    assert np.all(np.log2(errors[:-1] / errors[1:]) > 3.5)


def test_a_control_of_the_wrong_size():
    with pytest.raises(ProblemError, match="shape"):
        AdjointSimulation(problem=one_mass_oscillator()).evaluate(np.zeros(3))


def test_no_steps():
    with pytest.raises(ProblemError, match="at least one step"):
        AdjointSimulation(problem=one_mass_oscillator(), steps_per_node=0)
