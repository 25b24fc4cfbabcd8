import numpy as np
import pytest

from gaitlab.signal.averaging import centred_means


@pytest.mark.parametrize("ratio", [1, 2, 9, 10, 20])
def test_a_straight_line_is_not_delayed(ratio):
    fast = np.arange(30.0 * ratio)
    slow = centred_means(fast, ratio)
    assert slow.shape == (30,)
    assert slow[1:-1] == pytest.approx(fast[::ratio][1:-1])


def test_window_is_as_wide_as_one_slow_sample():
    fast = np.zeros((100, 3))
    fast[46:56] = 1.0  # ten samples, nearly centred on sample 50
    assert centred_means(fast, 10)[5] == pytest.approx([0.95] * 3)
    assert centred_means(fast, 10).sum() == pytest.approx(3.0)


def test_ends_use_what_is_there():
    assert centred_means(np.ones(40), 10) == pytest.approx(1.0)
