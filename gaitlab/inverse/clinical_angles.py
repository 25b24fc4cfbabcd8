"""Joint angles with clinical signs from the axes of two segments, continuous in time."""

from collections.abc import Mapping
from typing import Literal

import numpy as np

from gaitlab.inverse.conventional_calibration import SIDES, SIGN
from gaitlab.inverse.conventional_geometry import rotation_y, rotation_z
from gaitlab.mocap.recording import Side

CURVES = (
    "pelvis_tilt",
    "pelvis_obliquity",
    "pelvis_rotation",
    "hip_flexion",
    "hip_adduction",
    "hip_rotation",
    "knee_flexion",
    "ankle_dorsiflexion",
    "foot_progression",
)
"""The nine curves of a gait report, each with the prefix left_ or right_."""
FURTHER_CURVES = ("knee_varus", "knee_rotation", "ankle_adduction", "ankle_rotation")
"""Curves that exist besides; their markers are less trustworthy."""

Forward = Literal["laboratory axis", "heading"]

NEAR_GIMBAL_LOCK = np.radians(75.0)  # far below 90: the search for the branch is exact, only slower
SHORTEST_WALK = 0.3  # [m] of pelvis travel; with less the pelvis itself shows what is forward
BACKWARDS = np.radians(120.0)  # pelvis against travel: who walks backwards still faces forward


def cardan_yxz(rotation: np.ndarray) -> np.ndarray:
    """Angles a [rad], shape (n, 3), with R = R_y(a_0) R_x(a_1) R_z(a_2), continuous over the frames that are there.

    (a_0 + pi, pi - a_1, a_2 + pi) is the same rotation; near gimbal lock the one next to the frame before is chosen,
    so a_1 may pass 90 deg. `rotation` has shape (n, 3, 3); frames with NaN stay NaN.
    """
    sine = np.clip(-rotation[:, 1, 2], -1.0, 1.0)
    angles = np.stack(
        [
            np.arctan2(rotation[:, 0, 2], rotation[:, 2, 2]),
            np.arcsin(sine),
            np.arctan2(rotation[:, 1, 0], rotation[:, 1, 1]),
        ],
        axis=1,
    )
    there = np.isfinite(angles.sum(axis=1))
    angles[~there] = np.nan
    seen = angles[there]
    if np.abs(seen[:, 1]).max(initial=0.0) > NEAR_GIMBAL_LOCK:
        seen = _continuous_branch(seen)
    if np.abs(seen[1:] - seen[:-1]).max(initial=0.0) > np.pi:
        seen = np.unwrap(seen, axis=0)
    angles[there] = seen
    return angles


def _continuous_branch(angles: np.ndarray) -> np.ndarray:
    """For every row (n, 3) the one of the two equal triples [rad] that is next to the row before.

    Two rows are as far apart as their twins, so a step changes the branch or not whatever the branch before it.
    """
    twin = np.stack([angles[:, 0] + np.pi, np.pi - angles[:, 1], angles[:, 2] + np.pi], axis=1)
    stay, change = _turn(angles[1:] - angles[:-1]), _turn(twin[1:] - angles[:-1])
    changes = (change**2).sum(axis=1) < (stay**2).sum(axis=1)
    on_twin = np.concatenate([[0], np.cumsum(changes)]) % 2 == 1
    return np.where(on_twin[:, None], twin, angles)


def _turn(angle: np.ndarray) -> np.ndarray:
    """The same angles [rad] within [-pi, pi), any shape."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def centred(angle: np.ndarray) -> np.ndarray:
    """A continuous curve [rad], shape (n,), moved by whole turns until its mean lies within half a turn of zero."""
    if not np.fmax.reduce(np.abs(angle)) > np.pi:  # also when nothing is there
        return angle
    return angle - 2 * np.pi * np.round(np.nanmean(angle) / (2 * np.pi))


def travel_heading(origin: np.ndarray, facing: np.ndarray) -> float:
    """Direction of travel [rad] about the vertical, 0 along the laboratory's x axis.

    From the first to the last position of the pelvis; with less than 0.3 m of travel, or for who walks backwards, the
    mean direction of the pelvis' forward axis.

    Args:
        origin: Of the pelvis, laboratory frame [m], shape (n, 3).
        facing: Its forward axis, laboratory frame, shape (n, 3).
    """
    there = np.isfinite(origin).all(axis=1) & np.isfinite(facing).all(axis=1)
    if not there.any():
        return 0.0
    path = origin[there]
    travel, mean = path[-1] - path[0], facing[there].mean(axis=0)
    looking = float(np.arctan2(mean[1], mean[0]))
    heading = float(np.arctan2(travel[1], travel[0]))
    stands = np.hypot(travel[0], travel[1]) < SHORTEST_WALK
    backwards = abs((heading - looking + np.pi) % (2 * np.pi) - np.pi) > BACKWARDS
    return looking if stands or backwards else heading


def forward_direction(heading: float, forward: Forward) -> float:
    """Direction called forward [rad] for a heading [rad]: itself, or the nearest laboratory axis, as Vicon does."""
    return heading if forward == "heading" else float(np.round(heading / (np.pi / 2)) * np.pi / 2)


def clinical_angles(rotations: Mapping[str, np.ndarray], forward: float) -> dict[str, np.ndarray]:
    """The nine curves and four more of both sides [rad], each of shape (n,), signs of the clinical convention.

    Pelvic tilt is positive anterior, obliquity up, rotation internal. Positive are hip flexion, adduction and internal
    rotation, knee flexion, varus and internal rotation, ankle dorsiflexion, adduction and internal rotation, internal
    foot progression. All are Y'X'Z' angles of the distal in the proximal axes. Foot progression is the inclination of
    the foot's long axis against the sagittal plane, as in Plug-in Gait.

    Args:
        rotations: pelvis, and with left_ and right_: thigh, shank, shank_torsioned, foot; columns are the axes forward,
            left, up in the laboratory frame, shape (n, 3, 3).
        forward: Direction called forward about the vertical [rad].
    """
    to_gait = rotation_z(-forward)
    pelvis = cardan_yxz(to_gait @ rotations["pelvis"])
    angles: dict[str, np.ndarray] = {}
    for side in SIDES:
        angles |= _pelvis_angles(pelvis, side) | _leg_angles(rotations, side) | _foot_angle(rotations, side, to_gait)
    return {name: centred(angle) for name, angle in angles.items()}


def _pelvis_angles(a: np.ndarray, side: Side) -> dict[str, np.ndarray]:
    s = SIGN[side]
    return {
        f"{side}_pelvis_tilt": a[:, 0],
        f"{side}_pelvis_obliquity": s * a[:, 1],
        f"{side}_pelvis_rotation": -s * a[:, 2],
    }


def _leg_angles(rotations: Mapping[str, np.ndarray], side: Side) -> dict[str, np.ndarray]:
    s = SIGN[side]
    thigh = rotations[f"{side}_thigh"]
    foot = rotations[f"{side}_foot"] @ rotation_y(-np.pi / 2)  # z from the toes to the heel: no lock at a right angle
    hip = cardan_yxz(rotations["pelvis"].transpose(0, 2, 1) @ thigh)
    knee = cardan_yxz(thigh.transpose(0, 2, 1) @ rotations[f"{side}_shank"])
    ankle = cardan_yxz(rotations[f"{side}_shank_torsioned"].transpose(0, 2, 1) @ foot)
    return {
        f"{side}_hip_flexion": -hip[:, 0],
        f"{side}_hip_adduction": -s * hip[:, 1],
        f"{side}_hip_rotation": -s * hip[:, 2],
        f"{side}_knee_flexion": knee[:, 0],
        f"{side}_knee_varus": -s * knee[:, 1],
        f"{side}_knee_rotation": -s * knee[:, 2],
        f"{side}_ankle_dorsiflexion": -np.pi / 2 - ankle[:, 0],
        f"{side}_ankle_adduction": -s * ankle[:, 2],
        f"{side}_ankle_rotation": -s * ankle[:, 1],
    }


def _foot_angle(rotations: Mapping[str, np.ndarray], side: Side, to_gait: np.ndarray) -> dict[str, np.ndarray]:
    foot = cardan_yxz(to_gait @ rotations[f"{side}_foot"] @ rotation_y(-np.pi / 2))
    return {f"{side}_foot_progression": -SIGN[side] * foot[:, 1]}
