"""Angles as signals."""

import numpy as np

from gaitlab.signal.runs import valid_rows


def unwrap(angles: np.ndarray) -> np.ndarray:
    """Removes jumps of 2 pi along the first axis, gaps included: each valid sample follows the last valid one before.

    Args:
        angles: Angles [rad], shape (n, ...); NaN where missing.

    Returns:
        Angles [rad], shape and NaN of `angles`.
    """
    y = np.array(angles, dtype=float, order="C")
    columns = y.reshape(len(y), -1)
    for k in range(columns.shape[1]):
        valid = valid_rows(columns[:, k])
        columns[valid, k] = np.unwrap(columns[valid, k])
    return columns.reshape(y.shape)
