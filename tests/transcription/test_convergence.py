"""The collocation is of fourth order: halving the intervals divides the error by sixteen."""

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_bvp, solve_ivp

from gaitlab.nlp.interior_point import InteriorPoint
from gaitlab.ocp.mechanical import ContactStage, MechanicalModel
from gaitlab.transcription.mechanical_functions import point_functions
from gaitlab.transcription.mechanical_layout import Boundary, MechanicalLayout
from gaitlab.transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure

BOTH = (0, 1)


def one_coordinate(output, n_residual):
    """A mechanical model without contacts whose only criterion is half the square of its output."""
    q, v, a, y = (ca.SX.sym(name) for name in "qvay")
    none = ca.SX(0, 1)
    return MechanicalModel(
        q=q,
        v=v,
        a=a,
        f=ca.SX.sym("f", 0),
        p=ca.SX.sym("p", 1),
        d=ca.SX.sym("d", 0),
        outputs=output(q, v, a),
        n_residual=n_residual,
        y=y,
        criteria=0.5 * y**2,
        positions=none,
        velocities=none,
    )


def solve(model, duration, n, given):
    """States at the nodes, shape (n + 1, 2), and the objective; `given` maps nodes to states."""
    stage = ContactStage(
        duration=duration,
        n_intervals=n,
        active=(),
        landing=(),
        grounded=(),
        clear=(),
        force_cone=np.zeros((0, 0)),
        data=np.zeros(0),
    )
    boundary = Boundary(tuple((node, BOTH) for node in given))
    layout = MechanicalLayout((stage,), n_q=1, n_f=0, n_r=model.n_residual, boundary=boundary)
    states = np.zeros((n + 1, 2))
    for node, state in given.items():
        states[node] = state
    data = MechanicalData(
        p=np.zeros(1),
        theta=np.ones(1) * (model.n_residual == 0),
        reference=states,
        tracking=np.zeros((n + 1, 2)),
        given=states,
        lower=np.zeros(1),
        upper=np.zeros(1),
        acceleration_weights=np.zeros(1),
    )
    problem = MechanicalProblem(MechanicalStructure(layout, point_functions(model)), data)
    solution = InteriorPoint(tol=1e-10).solve(problem, states.ravel())
    assert solution.is_optimal(1e-9), solution
    return problem.states(solution.w), solution.f


def orders(errors):
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def test_optimal_control_of_an_oscillator():
    """Minimise the integral of u^2 / 2, q'' + q = u: u'' + u = 0, so u = cos t and q = sin t + (t / 2) sin t."""
    model, duration = one_coordinate(lambda q, v, a: a + q, 0), 2.0

    def exact(t):
        return np.stack([np.sin(t) + t / 2 * np.sin(t), np.cos(t) + np.sin(t) / 2 + t / 2 * np.cos(t)], axis=-1)

    state_errors, cost_errors = [], []
    for n in (4, 8, 16):
        states, cost = solve(model, duration, n, {0: exact(0.0), n: exact(duration)})
        state_errors.append(np.abs(states - exact(np.linspace(0.0, duration, n + 1))).max())
        cost_errors.append(abs(cost - (duration / 4 + np.sin(2 * duration) / 8)))
    assert np.all(orders(state_errors) > 3.7), state_errors
    assert np.all(orders(cost_errors) > 3.7), cost_errors


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_motion_of_a_pendulum(damping):
    """Only the first state is given: what is not actuated, a + sin q + c v = 0, determines the rest."""
    model, duration, first = one_coordinate(lambda q, v, a: a + ca.sin(q) + damping * v, 1), 3.0, np.array([1.0, 0.5])
    exact = solve_ivp(
        lambda t, x: [x[1], -np.sin(x[0]) - damping * x[1]], (0, duration), first, rtol=1e-12, atol=1e-12
    ).y[:, -1]
    errors = [np.abs(solve(model, duration, n, {0: first})[0][-1] - exact).max() for n in (6, 12, 24)]
    assert np.all(orders(errors) > 3.7), errors


def test_swing_up_agrees_with_the_maximum_principle():
    """Minimise the integral of u^2 / 2, u = q'' + sin q, from hanging to upright: u'' + cos(q) u = 0. Not convex."""
    duration, n = 3.0, 40
    t = np.linspace(0.0, duration, n + 1)
    guess = np.stack([np.pi * t / duration, np.full(n + 1, np.pi / duration), 0 * t, 0 * t])
    boundary_value = solve_bvp(
        lambda t, y: np.stack([y[1], y[2] - np.sin(y[0]), y[3], -np.cos(y[0]) * y[2]]),
        lambda a, b: np.array([a[0], a[1], b[0] - np.pi, b[1]]),
        t, guess, tol=1e-8, max_nodes=5000,
    )  # fmt: skip
    assert boundary_value.success
    model = one_coordinate(lambda q, v, a: a + ca.sin(q), 0)
    states, cost = solve(model, duration, n, {0: [0.0, 0.0], n: [np.pi, 0.0]})
    exact = boundary_value.sol(t)
    np.testing.assert_allclose(states, exact[:2].T, atol=1e-4)
    fine = np.linspace(0.0, duration, 2001)
    assert cost == pytest.approx(np.trapezoid(0.5 * boundary_value.sol(fine)[2] ** 2, fine), rel=1e-4)
