"""Time derivatives of sampled signals."""

import numpy as np

from gaitlab.signal.runs import runs, valid_rows


def derivative(x: np.ndarray, rate: float) -> np.ndarray:
    """First derivative by central differences, second order also at the ends of each run of valid samples.

    dx_i = (x_{i+1} - x_{i-1}) rate / 2; no difference is taken across a gap.

    Args:
        x: Samples, shape (n, ...); NaN where missing.
        rate: Samples per second [Hz].

    Returns:
        Unit of `x` per second, shape of `x`; NaN where `x` is missing and in runs of one sample.
    """
    y = np.full(x.shape, np.nan)
    for start, end in runs(valid_rows(x)):
        if end - start > 1:
            order = 2 if end - start > 2 else 1
            y[start:end] = np.gradient(x[start:end], 1.0 / rate, axis=0, edge_order=order)
    return y


def second_derivative(x: np.ndarray, rate: float) -> np.ndarray:
    """Second derivative by ddx_i = (x_{i+1} - 2 x_i + x_{i-1}) rate^2; the ends of each run repeat their neighbour.

    Args:
        x: Samples, shape (n, ...); NaN where missing.
        rate: Samples per second [Hz].

    Returns:
        Unit of `x` per second squared, shape of `x`; NaN where `x` is missing and in runs of fewer than three samples.
    """
    y = np.full(x.shape, np.nan)
    for start, end in runs(valid_rows(x)):
        if end - start > 2:
            y[start + 1 : end - 1] = np.diff(x[start:end], n=2, axis=0) * rate**2
            y[start], y[end - 1] = y[start + 1], y[end - 2]
    return y
