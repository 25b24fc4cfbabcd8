"""Given states as unknowns: conditions of planted feet, interpolation, and how an optimal walk follows them."""

import numpy as np
import pytest
from demo_stride import demo_stride
from scipy.interpolate import CubicHermiteSpline

from gaitlab.ocp.mechanical import ContactStage
from gaitlab.transcription.mechanical_layout import Boundary, MechanicalLayout
from gaitlab.walking.given_states import StateCondition, sampling_table, spread_moves, state_conditions
from gaitlab.walking.identification import IdentificationSettings, WalkLevel
from gaitlab.walking.joint_search import JointSearch, MeasuredFrames, _Run, _State  # pyright: ignore[reportPrivateUsage]
from gaitlab.walking.node_damping import NodeDamping
from gaitlab.walking.tracking import track

HEEL, N_F = (0, 1, 2), 3


def stage(active, n_intervals, grounded=()):
    return ContactStage(
        duration=0.1 * n_intervals,
        n_intervals=n_intervals,
        active=active,
        landing=active if grounded else (),
        grounded=grounded,
        clear=(),
        force_cone=np.zeros((0, N_F)),
        data=np.zeros(1),
    )


def test_a_planted_foot_rests_on_the_floor_and_stays():
    layout = MechanicalLayout((stage((), 2), stage(HEEL, 4, (2,)), stage((), 2)), 6, N_F, 6, Boundary())
    found = state_conditions(layout, np.array([0, 2, 4, 6, 8]))
    at_rest = [StateCondition(state=k, component=N_F + i) for k in (1, 2, 3) for i in HEEL]
    in_place = [StateCondition(state=k, component=i, minus=k - 1) for k in (2, 3) for i in HEEL]
    assert set(found) == {*at_rest, *in_place, StateCondition(state=1, component=2)}


def test_a_foot_that_lands_within_an_arc_stands_on_the_floor_at_its_end():
    layout = MechanicalLayout((stage((), 1), stage(HEEL, 3, (2,))), 6, N_F, 6, Boundary())
    found = state_conditions(layout, np.array([0, 2, 4]))
    assert StateCondition(state=1, component=2) in found
    assert not any(condition.state == 1 and condition.component in (0, 1) for condition in found)


def test_sampling_is_the_cubic_between_nodes():
    nodes, random = np.array([0.0, 0.1, 0.25, 0.4]), np.random.default_rng(2)
    values, rates = random.standard_normal((2, 4))
    times = np.array([0.0, 0.03, 0.1, 0.2, 0.4])
    table = sampling_table(nodes, times)
    expected = CubicHermiteSpline(nodes, values, rates)(times)
    np.testing.assert_allclose(table[:, :, 0] @ values + table[:, :, 1] @ rates, expected, atol=1e-14)


def test_colours_are_told_apart():
    moves = np.zeros((5, 1, 2))  # one entry per state, nodes 0, 2, 4 given
    moves[1], moves[3] = [[10.0, 1.0]], [[20.0, 2.0]]
    full = spread_moves(moves, np.array([0, 2, 4]))[:, 0, :, 0]
    np.testing.assert_array_equal(full, [[1, 0, 0], [10, 1, 0], [0, 1, 0], [0, 2, 20], [0, 0, 1]])


@pytest.fixture(scope="module")
def run():
    level = WalkLevel(track(demo_stride()), IdentificationSettings())
    theta = np.full(4, 0.25)
    stride = level.tracked.stride
    times = np.arange(stride.times[0], stride.times[-1], 0.01)
    n, n_q = len(times), stride.n_q
    information = np.broadcast_to(np.eye(n_q), (n, n_q, n_q))
    zero = np.zeros((n, n_q))
    frames = MeasuredFrames(times=times, q=zero, little_smoothed=zero, information=information, noise=1.0)
    state = _State(level, theta, level.from_tracking(theta))
    damping = NodeDamping(scale=np.ones(2 * n_q), factors=np.ones(len(level.given)), least=1.0)
    return _Run(JointSearch(), frames, 1.0, state, damping, None)


def test_residuals_follow_weights_and_given_states_as_their_derivatives_say(run):
    """Against the walk solved again after a step of the weights and of every given state, within the contacts.

    The step is tiny: a foot on two points has no moment about the line between them, and moving the body sideways there
    takes large motions within the arc.
    """
    lin, level, size = run._linearised(), run.state.level, 1e-7
    contacts = run.conditions.values(level.given)[1].reshape(len(run.conditions.rows), -1)
    random = np.random.default_rng(3)
    free = np.linalg.svd(contacts)[2][np.linalg.matrix_rank(contacts) :]
    step = size * (free.T @ random.standard_normal(len(free))).reshape(level.given.shape)
    change = size * np.array([1.0, -1.0, 2.0, -2.0])
    both = [run._moved(lin, run.state.theta + sign * change, sign * step) for sign in (1.0, -1.0)]
    measured = (run.misfit(both[0]) - run.misfit(both[1])).ravel() / 2.0
    expected = (lin.by_theta @ change + lin.by_states @ step.ravel())[: measured.size]
    assert np.linalg.norm(measured - expected) < 5e-3 * np.linalg.norm(expected)


def test_normalisers_leave_out_noise_but_half_stays(run):
    level, optimum = run.state.level, run.state.optimum
    values = level.normaliser_values(optimum.problem, optimum.solution.w)
    noise = np.zeros_like(values)
    noise[0], noise[-1] = 0.1 * values[0], 2.0 * values[-1]
    renewed, theta = level.normalised_at(optimum, run.state.theta, noise)
    np.testing.assert_allclose(renewed.all_normalisers, [0.9 * values[0], *values[1:-1]])
    assert renewed.acceleration_normaliser == pytest.approx(0.5 * values[-1])
    assert theta.sum() == pytest.approx(1.0)
