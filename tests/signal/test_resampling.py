import numpy as np
import pytest

from gaitlab.signal.resampling import normalise_cycle, resample

RATE = 100.0
T = np.arange(200) / RATE


def test_a_cycle_has_101_samples_from_strike_to_strike():
    y = normalise_cycle(np.sin(2 * np.pi * T), RATE, start=0.255, end=1.365)
    assert y.shape == (101,)
    assert y == pytest.approx(np.sin(2 * np.pi * np.linspace(0.255, 1.365, 101)), abs=1e-5)


def test_samples_themselves_come_back():
    x = np.random.default_rng(1).normal(size=(200, 3))
    assert resample(x, RATE, T) == pytest.approx(x)


def test_gaps_and_outside_stay_missing():
    x = np.ones(200)
    x[50:60] = np.nan
    y = resample(x, RATE, np.array([-0.1, 0.3, 0.55, 0.595, 0.6, 1.99, 2.1]))
    np.testing.assert_array_equal(np.isnan(y), [True, False, True, True, False, False, True])
