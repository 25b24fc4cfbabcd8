import numpy as np
import pytest

from gaitlab.signal.resampling import resample

RATE = 100.0
T = np.arange(200) / RATE


def test_samples_themselves_come_back():
    x = np.random.default_rng(1).normal(size=(200, 3))
    assert resample(x, RATE, T) == pytest.approx(x)


def test_gaps_and_outside_stay_missing():
    x = np.ones(200)
    x[50:60] = np.nan
    y = resample(x, RATE, np.array([-0.1, 0.3, 0.55, 0.595, 0.6, 1.99, 2.1]))
    np.testing.assert_array_equal(np.isnan(y), [True, False, True, True, False, False, True])
