"""Means of fast samples around slow ones."""

import numpy as np


def centred_means(samples: np.ndarray, ratio: int) -> np.ndarray:
    """Centred means of `ratio` fast samples around each slow one; a one-sided mean would delay by half a frame.

    Args:
        samples: Fast samples, the first one simultaneous with the first slow one, shape (n * ratio, ...).
        ratio: Fast samples per slow one.

    Returns:
        Shape (n, ...). The window is ratio samples wide (when even, ratio + 1 with the ends weighted by one half),
        narrower at the ends of the trial.
    """
    weights = np.ones(ratio + 1 - ratio % 2)
    if ratio % 2 == 0:
        weights[[0, -1]] = 0.5
    half = len(weights) // 2
    n = len(samples)
    padded = np.zeros((n + 2 * half, *samples.shape[1:]))
    padded[half : half + n] = samples
    present = np.zeros(n + 2 * half)
    present[half : half + n] = 1.0
    centres = np.arange(0, n, ratio)
    total = sum(weight * padded[centres + k] for k, weight in enumerate(weights))
    share = sum(weight * present[centres + k] for k, weight in enumerate(weights))
    return np.asarray(total) / np.asarray(share).reshape(-1, *([1] * (samples.ndim - 1)))
