"""Resampling: cubic interpolation between valid samples."""

import numpy as np
from scipy.interpolate import CubicSpline

from gaitlab.signal.runs import runs, valid_rows

SNAP = 1e-6  # samples; times this close to the end of a run belong to it


def resample(x: np.ndarray, rate: float, at: np.ndarray) -> np.ndarray:
    """Values at the given times, by a cubic spline through each run of valid samples.

    Args:
        x: Samples at 0, 1 / rate, 2 / rate ..., shape (n, ...); NaN where missing.
        rate: Samples per second [Hz].
        at: Times [s] from the first sample, shape (m,).

    Returns:
        Unit of `x`, shape (m, ...); NaN outside the samples and inside gaps: nothing is invented.
    """
    position = np.asarray(at, dtype=float) * rate
    y = np.full((len(position), *x.shape[1:]), np.nan)
    for start, end in runs(valid_rows(x)):
        inside = (position >= start - SNAP) & (position <= end - 1 + SNAP)
        if end - start == 1:
            y[inside] = x[start]
        elif inside.any():
            y[inside] = CubicSpline(np.arange(start, end), x[start:end], axis=0)(position[inside])
    return y
