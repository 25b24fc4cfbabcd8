import numpy as np
import pytest

from gaitlab.clinical.cycle_average import average, complete, time_normalise, time_normalise_forces
from gaitlab.mocap.cycle import Cycle

RATE = 100.0


def cycle(start, end):
    return Cycle(side="left", start=start, end=end, foot_off=None, opposite_foot_off=None, opposite_foot_strike=None)


def test_a_straight_line_is_sampled_exactly():
    seconds = np.arange(200) / RATE
    expected = np.linspace(0.2, 1.335, 101)
    assert time_normalise(seconds, RATE, cycle(0.2, 1.335)) == pytest.approx(expected, abs=1e-12)


def test_a_missing_frame_leaves_only_its_neighbourhood_empty():
    values = np.ones(101)
    values[50] = np.nan
    sampled = time_normalise(values, RATE, cycle(0.0, 1.0))
    assert np.flatnonzero(np.isnan(sampled)).tolist() == [50]


def test_a_cycle_that_leaves_the_recording_is_empty_there():
    sampled = time_normalise(np.ones(101), RATE, cycle(0.5, 1.5))
    assert np.isfinite(sampled).sum() == 51


def test_average_counts_complete_cycles_only():
    curves = [np.zeros(101), np.full(101, 2.0), np.full(101, np.nan)]
    mean, deviation = average(complete(curves))
    assert mean == pytest.approx(np.ones(101))
    assert deviation == pytest.approx(np.full(101, np.sqrt(2.0)))


def test_average_of_nothing_is_unknown():
    assert np.isnan(average([])).all()


def test_forces_are_held_up_to_the_strike_that_ends_the_cycle():
    known = np.arange(101.0)
    known[51:] = np.nan  # the next stance is not measured; the strike lies between frames 50 and 51
    ended = cycle(0.1, 0.504)
    assert np.isnan(time_normalise(known, RATE, ended)[-1])
    assert time_normalise_forces(known, RATE, ended)[-1] == 50.0 and np.isnan(known[51])
