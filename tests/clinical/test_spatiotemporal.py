import numpy as np
import pytest

from gaitlab.clinical.spatiotemporal import cycle_spatiotemporal, mean, normalise, standard_deviation
from gaitlab.mocap.cycle import Cycle

RATE = 100.0
CYCLE = Cycle(side="left", start=1.0, end=2.0, foot_off=1.6, opposite_foot_off=1.1, opposite_foot_strike=1.5)


def straight_walk(heading):
    """Left foot at 0, then 1.2 m; right foot lands at 0.7 m, 0.1 m to the right. Turned by `heading` [rad]."""
    frames = 301
    left, right = np.zeros((frames, 3)), np.zeros((frames, 3))
    left[:, 0] = np.where(np.arange(frames) > 150, 1.2, 0.0)
    right[:] = (0.7, -0.1, 0.0)
    turn = np.array([[np.cos(heading), -np.sin(heading), 0], [np.sin(heading), np.cos(heading), 0], [0, 0, 1]])
    return {"left": left @ turn.T, "right": right @ turn.T}


@pytest.mark.parametrize("heading", [0.0, 1.0, np.pi])
def test_distances_do_not_depend_on_the_walking_direction(heading):
    result = cycle_spatiotemporal(CYCLE, straight_walk(heading), RATE)
    distances = (result.stride_length_m, result.step_length_m, result.step_width_m, result.speed_m_per_s)
    assert distances == pytest.approx((1.2, 0.5, 0.1, 1.2))


def test_phases_are_percent_of_the_cycle():
    result = cycle_spatiotemporal(CYCLE, straight_walk(0.0), RATE)
    phases = (result.foot_off_percent, result.single_support_percent, result.double_support_percent)
    assert phases == pytest.approx((60.0, 40.0, 20.0))
    assert (result.stance_percent, result.swing_percent) == pytest.approx((60.0, 40.0))


def test_cadence_counts_both_steps_of_a_stride():
    assert cycle_spatiotemporal(CYCLE, straight_walk(0.0), RATE).cadence_steps_per_min == pytest.approx(120.0)


def test_what_an_absent_event_leaves_unknown_is_null():
    partial = Cycle(side="left", start=1.0, end=2.0, foot_off=None, opposite_foot_off=None, opposite_foot_strike=None)
    result = cycle_spatiotemporal(partial, straight_walk(0.0), RATE)
    assert (result.step_length_m, result.foot_off_percent, result.double_support_percent) == (None, None, None)
    assert result.stride_length_m == pytest.approx(1.2)


def test_one_cycle_has_a_mean_but_no_deviation():
    result = cycle_spatiotemporal(CYCLE, straight_walk(0.0), RATE)
    assert mean([result]) == result
    assert standard_deviation([result]).speed_m_per_s is None


def test_normalised_speed_is_the_root_of_the_froude_number():
    values = cycle_spatiotemporal(CYCLE, straight_walk(0.0), RATE)
    assert normalise(values, 0.8).speed == pytest.approx(1.2 / np.sqrt(9.81 * 0.8))
    assert normalise(values, None).speed is None
