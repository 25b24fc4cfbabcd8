"""Smooth states near noisy measurements."""

import numpy as np

from gaitlab.pipelines.gait_cases import load_case
from gaitlab.walking.gait_guess import smooth_states


def test_the_guess_keeps_the_given_states_and_smooths():
    case = load_case("cp-child")
    gait, measured = case.gait, case.measured(1.0, 0)
    guess = smooth_states(gait.states, gait.durations, measured.q)
    for states, ends, q, truth in zip(guess, gait.states, measured.q, case.q, strict=True):
        np.testing.assert_allclose(states[[0, -1]], ends, atol=1e-9)
        n_q = q.shape[1]
        assert np.std(states[1:-1, :n_q] - truth[1:-1]) < 0.7 * np.std(q[1:-1] - truth[1:-1])
