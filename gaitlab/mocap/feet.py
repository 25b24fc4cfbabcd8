"""How fast the feet move: the signal that tells stance from swing, whatever the walking direction and foot posture."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.labels import FOREFOOT, PELVIS, REARFOOT
from gaitlab.mocap.recording import Recording, Side
from gaitlab.signal.derivatives import derivative
from gaitlab.signal.filtering import low_pass
from gaitlab.signal.gaps import fill_gaps

PELVIS_CUT_OFF = 6.0  # Hz; only the mean speed is wanted
SLOWEST_WALK = 0.1  # m/s; below it a trial holds no walking


@dataclass(frozen=True, kw_only=True)
class FootMotion:
    """Positions and speeds of one foot."""

    side: Side
    heel: np.ndarray
    """Rearfoot marker, laboratory frame [m], shape (n_frames, 3); NaN where none is seen."""
    toe: np.ndarray
    """Forefoot marker, laboratory frame [m], shape (n_frames, 3); NaN where none is seen."""
    heel_speed: np.ndarray
    """|v| of the rearfoot marker [m/s], shape (n_frames,)."""
    toe_speed: np.ndarray
    """|v| of the forefoot marker [m/s], shape (n_frames,)."""


def foot_motion(recording: Recording, side: Side, cut_off: float) -> FootMotion:
    """Motion of heel and toe; in each frame that of the first rearfoot and forefoot marker that is seen.

    Args:
        recording: The trial.
        side: Which foot.
        cut_off: Low-pass cut-off [Hz]; lowered to 0.4 of the frame rate for slow cameras.

    Raises:
        InvalidRecording: No rearfoot or no forefoot marker is ever seen.
    """
    letter = side[0].upper()
    heel, heel_speed = _first_seen(recording, [letter + name for name in REARFOOT], cut_off)
    toe, toe_speed = _first_seen(recording, [letter + name for name in FOREFOOT], cut_off)
    return FootMotion(side=side, heel=heel, toe=toe, heel_speed=heel_speed, toe_speed=toe_speed)


def _first_seen(recording: Recording, names: Sequence[str], cut_off: float) -> tuple[np.ndarray, np.ndarray]:
    """Position and speed, frame by frame from the first marker of `names` that is seen there."""
    filled, _ = fill_gaps(
        {name: recording.markers[name] for name in names if name in recording.markers}, recording.rate
    )
    position = np.full((recording.n_frames, 3), np.nan)
    speed = np.full(recording.n_frames, np.nan)
    for marker in filled.values():
        smooth = _smooth(marker, recording.rate, cut_off)
        marker_speed = _speed(smooth, recording.rate)
        unseen = np.isnan(speed)
        position[unseen] = smooth[unseen]
        speed[unseen] = marker_speed[unseen]
    if np.isnan(speed).all():
        raise InvalidRecording(
            f"{recording.name}: none of the markers {', '.join(names)} is visible, so gait events cannot be found; "
            "label heel and toe, or mark the events in the file"
        )
    return position, speed


def _smooth(x: np.ndarray, rate: float, cut_off: float) -> np.ndarray:
    return low_pass(x, rate, min(cut_off, 0.4 * rate))


def _speed(x: np.ndarray, rate: float) -> np.ndarray:
    return np.linalg.norm(derivative(x, rate), axis=1)


def walking_speed(recording: Recording) -> float:
    """Median speed of the pelvis while it moves [m/s]: over the frames faster than half of its 95th percentile.

    Raises:
        InvalidRecording: No pelvis marker is visible, or nobody walks.
    """
    rate = recording.rate
    speeds = [
        _speed(_smooth(recording.markers[name], rate, PELVIS_CUT_OFF), rate)
        for name in PELVIS
        if name in recording.markers
    ]
    together = np.concatenate([*speeds, np.empty(0)])
    together = together[np.isfinite(together)]
    if together.size == 0:
        raise InvalidRecording(
            f"{recording.name}: no pelvis marker ({', '.join(PELVIS)}) is visible; label the pelvis markers"
        )
    speed = float(np.median(together[together >= 0.5 * np.percentile(together, 95)]))
    if speed < SLOWEST_WALK:
        raise InvalidRecording(
            f"{recording.name}: nobody walks in this trial (the pelvis moves at {speed:.2f} m/s); give a walking trial"
        )
    return speed
