"""Curves over the gait cycle: cut at the foot strikes, stretched to 0-100 %, averaged."""

from collections.abc import Sequence

import numpy as np

from ..mocap.cycle import Cycle

N_SAMPLES = 101
SNAP = 1e-6  # frames


def time_normalise(values: np.ndarray, rate: float, cycle: Cycle) -> np.ndarray:
    """Sample a curve at 0, 1 ... 100 % of a cycle, linear between frames.

    Args:
        values: Curve per frame, any unit, shape (n_frames,); NaN where unknown.
        rate: Frames per second [Hz].
        cycle: Times [s] from the first frame.

    Returns:
        Shape (101,); NaN where a neighbouring frame is unknown or the cycle leaves the recording.
    """
    position = np.linspace(cycle.start, cycle.end, N_SAMPLES) * rate
    nearest = np.round(position)
    position = np.where(np.abs(position - nearest) <= SNAP, nearest, position)
    inside = (position >= 0) & (position <= len(values) - 1)
    low = np.floor(np.where(inside, position, 0.0)).astype(int)
    high = np.minimum(low + 1, len(values) - 1)
    weight = np.where(inside, position, 0.0) - low
    mixed = np.where(weight == 0.0, values[low], (1.0 - weight) * values[low] + weight * values[high])
    return np.where(inside, mixed, np.nan)


def time_normalise_forces(values: np.ndarray, rate: float, cycle: Cycle) -> np.ndarray:
    """As `time_normalise`, for what is known only while the ground reaction is: shape (n_frames,) to (101,).

    The last frame of the cycle is held beyond the strike that ends it: the next stance may be unknown, and the strike
    lies between the last frame before it and the first frame in it.
    """
    last = int(np.floor(cycle.end * rate))
    if last + 1 < len(values) and np.isnan(values[last + 1]):
        values = values.copy()
        values[last + 1] = values[last]
    return time_normalise(values, rate, cycle)


def complete(curves: Sequence[np.ndarray]) -> list[np.ndarray]:
    """The curves, shape (101,) each, any unit, that have no gap."""
    return [curve for curve in curves if np.all(np.isfinite(curve))]


def average(curves: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Mean and sample standard deviation, shape (101,) each, unit of the curves; the latter NaN with fewer than two."""
    if not curves:
        return np.full(N_SAMPLES, np.nan), np.full(N_SAMPLES, np.nan)
    stacked = np.array(curves)  # (n_cycles, 101)
    deviation = np.std(stacked, axis=0, ddof=1) if len(curves) > 1 else np.full(N_SAMPLES, np.nan)
    return np.mean(stacked, axis=0), deviation
