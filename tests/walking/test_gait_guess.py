"""Smooth states near noisy measurements."""

import numpy as np
import pytest

from gaitlab.multibody.kinematics import point_positions
from gaitlab.pipelines.gait_cases import CASES, load_case
from gaitlab.walking.point_foot_gait import GaitLevel


@pytest.fixture(scope="module", params=CASES)
def level(request):
    case = load_case(request.param)
    return GaitLevel(case.gait, case.measured(1.0, 0)), case.q


def test_the_guess_keeps_the_given_states_and_smooths(level):
    level, true = level
    gait, measured = level.gait, level.measured
    for states, ends, q, truth in zip(level.first, gait.states, measured.q, true, strict=True):
        np.testing.assert_allclose(states[[0, -1]], ends, atol=1e-9)
        n_q = q.shape[1]
        assert np.std(states[1:-1, :n_q] - truth[1:-1]) < 0.7 * np.std(q[1:-1] - truth[1:-1])


def test_rates_of_the_guess_are_those_of_its_coordinates(level):
    level, _ = level
    n_q = level.n_q
    for states, duration in zip(level.first, level.gait.durations, strict=True):
        h = duration / (len(states) - 1)
        q, v = states[:, :n_q], states[:, n_q:]
        # Simpson's rule of the rates over two intervals.
        np.testing.assert_allclose(h / 3 * (v[:-2] + 4 * v[1:-1] + v[2:]), q[2:] - q[:-2], atol=2e-3)


def test_the_standing_point_stays_in_place(level):
    level, _ = level
    subject = level.gait.subject
    for states, toe in zip(level.first, ("right_toe", "left_toe", "right_toe"), strict=True):
        places = point_positions(subject, subject.contacts, states[:, : subject.n_q])[toe]
        np.testing.assert_allclose(places, np.broadcast_to(places[0], places.shape), atol=5e-4)
