"""Which way is up: some laboratories export y up; everything here has z up."""

from collections.abc import Mapping

import numpy as np

from gaitlab.mocap.labels import FOREFOOT, PELVIS, REARFOOT

CLEAR = 0.8  # share of the largest component in the vector from feet to pelvis

_TO_Z_UP: Mapping[str, tuple[tuple[int, int, int], ...]] = {
    "-z": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "+y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "+x": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "-x": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
}


def rotation_to_z_up(markers: Mapping[str, np.ndarray]) -> tuple[np.ndarray, str]:
    """Rotation that makes z point up, and the file's own vertical axis ('+z', '+y' ...).

    The vertical is the axis along which the pelvis markers are above the feet's, in the median over the frames.

    Args:
        markers: Canonical name to positions in the file's axes, any unit, shape (n_frames, 3).

    Returns:
        R, shape (3, 3), with z_up = R file; the identity when the vertical is +z or cannot be told.
    """
    pelvis = _middle(markers, PELVIS)
    feet = _middle(markers, [side + name for side in "LR" for name in REARFOOT + FOREFOOT])
    up = pelvis - feet
    if not np.isfinite(up).all() or np.abs(up).max() < CLEAR * np.linalg.norm(up):
        return np.eye(3), "+z"
    k = int(np.argmax(np.abs(up)))
    axis = ("+" if up[k] > 0 else "-") + "xyz"[k]
    return np.array(_TO_Z_UP.get(axis, np.eye(3)), dtype=float), axis


def _middle(markers: Mapping[str, np.ndarray], names: "tuple[str, ...] | list[str]") -> np.ndarray:
    """Median position over frames and markers, shape (3,); NaN when none is seen."""
    rows = [markers[name] for name in names if name in markers]
    together = np.concatenate([*rows, np.empty((0, 3))])
    seen = together[np.isfinite(together).all(axis=1)]
    return np.median(seen, axis=0) if len(seen) else np.full(3, np.nan)
