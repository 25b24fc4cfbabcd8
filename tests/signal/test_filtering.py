import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.signal.filtering import low_pass

RATE = 100.0
T = np.arange(1000) / RATE
MIDDLE = slice(300, 700)


def gain(frequency: float, cut_off: float) -> float:
    y = low_pass(np.sin(2 * np.pi * frequency * T), RATE, cut_off)
    return float(np.abs(y[MIDDLE]).max())


def test_cut_off_is_the_half_power_frequency_of_the_double_pass():
    assert gain(6.0, cut_off=6.0) == pytest.approx(np.sqrt(0.5), abs=0.005)


def test_effective_order_is_four():
    """|H|^2 = 1 / (1 + (sqrt(2) - 1) r^4)^2 with r = tan(pi f / rate) / tan(pi f_c / rate)."""
    r = np.tan(np.pi * 12.0 / RATE) / np.tan(np.pi * 6.0 / RATE)
    assert gain(12.0, cut_off=6.0) == pytest.approx(1.0 / (1.0 + (np.sqrt(2.0) - 1.0) * r**4), abs=0.005)


def test_no_phase_lag():
    x = np.sin(2 * np.pi * 2.0 * T)
    assert low_pass(x, RATE, 20.0)[MIDDLE] == pytest.approx(x[MIDDLE], abs=1e-3)


def test_each_run_of_valid_samples_is_filtered_alone():
    x = np.column_stack([T, 2.0 * T])
    x[400:420] = np.nan
    y = low_pass(x, RATE, 6.0)
    assert np.isnan(y[400:420]).all()
    assert y[:400] == pytest.approx(low_pass(x[:400], RATE, 6.0))
    assert y[420:] == pytest.approx(low_pass(x[420:], RATE, 6.0))


@pytest.mark.parametrize("length", [1, 2, 3, 10])
def test_short_runs_keep_a_constant(length):
    assert low_pass(np.full((length, 3), 5.0), RATE, 6.0) == pytest.approx(5.0)


@pytest.mark.parametrize("cut_off", [0.0, 50.0, np.nan])
def test_impossible_cut_off(cut_off):
    with pytest.raises(ProblemError, match="between 0 and half the rate, 50 Hz"):
        low_pass(T, RATE, cut_off)
