"""One stride of a real child, explained: the promises on tracking, certificate and fit, and the derivatives."""

import numpy as np
import pytest
from demo_stride import first_stride

from gaitlab.bilevel.implicit_gauss_newton import ImplicitGaussNewton
from gaitlab.bilevel.result import rms
from gaitlab.pipelines.analyse import Sources, analyse_files
from gaitlab.pipelines.optimal_arrays import optimal_arrays
from gaitlab.pipelines.options import AnalysisOptions
from gaitlab.walking.explanation import explain

pytestmark = [pytest.mark.shared_data, pytest.mark.slow]

CHILD = "HC033A"
TRACKING_LIMIT, FIT_LIMIT, CERTIFICATE = 0.03, 0.06, 1e-6
DIFFERENCE = 1e-3


@pytest.fixture(scope="module")
def trial(shared_data):
    folder = shared_data / "children" / CHILD
    sources = Sources(walks=(next(folder.glob("straight_*.c3d")),), static=next(folder.glob("static_*.c3d")))
    return analyse_files(sources, AnalysisOptions(weights=False)).trials[0]


@pytest.fixture(scope="module")
def found(trial):
    return explain(first_stride(trial))


@pytest.fixture(scope="module")
def nearby(found):
    """Weights inside the simplex, beside the best ones, and their walk."""
    theta = 0.9 * found.estimate.theta + 0.1 / found.level.n_theta
    return theta, found.level.respond(theta, found.optimum.predict(theta - found.estimate.theta))


def test_tracking_stays_close(found):
    assert found.tracked.solution.is_optimal(CERTIFICATE)
    assert found.tracked.rms <= TRACKING_LIMIT


def test_optimum_is_certified(found):
    assert found.optimum.solution.is_optimal(CERTIFICATE)
    assert found.optimum.sensitivity.is_minimum()
    assert found.is_certified


def test_weights_lie_on_the_simplex(found):
    assert found.estimate.theta.sum() == pytest.approx(1.0, abs=1e-9)
    assert found.estimate.theta.min() >= 0.0


def test_fit_beats_equal_weights_and_every_single_criterion(found):
    fit = found.estimate.rms
    assert fit <= FIT_LIMIT
    assert fit < found.equal_rms
    assert len(found.single_rms) == found.level.n_theta
    assert all(fit < single for single in found.single_rms.values() if single is not None)


def test_the_problem_has_no_tracking_term_and_keeps_the_given_states(found):
    assert not found.optimum.problem.data.tracking.any()
    states, given = found.optimum.problem.states(found.optimum.solution.w), found.level.given_nodes
    np.testing.assert_allclose(states[given], found.tracked.states[given], atol=1e-6)


def test_jacobian_against_solving_again(found, nearby):
    theta, response = nearby
    jacobian = response.jacobian()
    for k in range(found.level.n_theta):
        step = DIFFERENCE * (np.eye(found.level.n_theta)[k] - 1.0 / found.level.n_theta)
        ends = [found.level.respond(theta + sign * step, response.predict(sign * step)) for sign in (1, -1)]
        difference = 0.5 * (ends[0].residual - ends[1].residual)
        error = np.linalg.norm(jacobian @ step - difference)
        assert error <= 1e-2 * np.linalg.norm(difference), found.level.settings.criteria[k]


def test_search_repeats_itself_and_comes_back(found, nearby):
    first, second = (ImplicitGaussNewton().solve(found.level, *nearby).theta for _ in range(2))
    np.testing.assert_allclose(first, second, atol=1e-6)
    np.testing.assert_allclose(first, found.estimate.theta, atol=5e-3)


def test_costs_add_up(found):
    """The parts of the cost are the objective."""
    assert sum(found.optimum.cost_terms().values()) == pytest.approx(found.optimum.solution.f, rel=1e-6)


def test_arrays_are_known_inside_the_stride_only(trial, found):
    recording, times = trial.recording, found.tracked.stride.times
    arrays = optimal_arrays(found, recording.n_frames, recording.rate, trial.kinematics.heading)
    frames = np.arange(recording.n_frames) / recording.rate
    inside = (frames >= times[0] - 1e-9) & (frames <= times[-1] + 1e-9)
    rows = {name: values.reshape(len(inside), -1) for name, values in arrays.items() if values.dtype.kind == "f"}
    assert {"q_tracked", "q_optimal", "tau_optimal", "forces_optimal", "criteria_share"} <= set(rows)
    for name, values in rows.items():
        np.testing.assert_array_equal(np.isfinite(values).all(axis=1), inside, err_msg=name)
    measured = trial.motion.q[inside]
    assert rms(arrays["q_tracked"][inside] - measured) <= TRACKING_LIMIT
    assert rms(arrays["q_optimal"][inside] - measured) <= FIT_LIMIT
