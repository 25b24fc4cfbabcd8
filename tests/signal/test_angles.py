import numpy as np
import pytest

from gaitlab.signal.angles import unwrap


def test_jumps_are_removed_across_gaps():
    truth = np.linspace(0.0, 12.0, 100)
    wrapped = np.column_stack([truth, -truth])
    wrapped = (wrapped + np.pi) % (2 * np.pi) - np.pi
    wrapped[40:50, 0] = np.nan
    y = unwrap(wrapped)
    assert np.isnan(y[40:50, 0]).all()
    assert y[50:, 0] == pytest.approx(truth[50:])
    assert y[:, 1] == pytest.approx(-truth)
