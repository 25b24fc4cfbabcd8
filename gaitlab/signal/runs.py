"""Runs of valid samples in a signal with missing values."""

import numpy as np


def valid_rows(x: np.ndarray) -> np.ndarray:
    """Which samples are complete: mask of shape (n,) for x of shape (n, ...)."""
    return np.asarray(np.isfinite(x.reshape(len(x), -1)).all(axis=1))


def runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """Maximal runs of true values of a mask of shape (n,), as (start, end) with end exclusive."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [(int(start), int(end)) for start, end in zip(edges[::2], edges[1::2], strict=True)]
