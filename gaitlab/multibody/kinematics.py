"""Kinematics of a subject in numpy, for many frames at once.

Rotations are R_y(y) R_x(x) R_z(z) with angles ordered (y, x, z), child to parent (thesis ch. 10).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gaitlab.multibody.subject import PointOnSegment, SubjectModel


def rotation_matrices(angles: np.ndarray) -> np.ndarray:
    """R_y R_x R_z of angles (..., 3) in the order y, x, z [rad], shape (..., 3, 3)."""
    (cy, cx, cz), (sy, sx, sz) = np.moveaxis(np.cos(angles), -1, 0), np.moveaxis(np.sin(angles), -1, 0)
    R = np.empty((*angles.shape, 3))
    R[..., 0, 0], R[..., 0, 1], R[..., 0, 2] = cy * cz + sy * sx * sz, sy * sx * cz - cy * sz, sy * cx
    R[..., 1, 0], R[..., 1, 1], R[..., 1, 2] = cx * sz, cx * cz, -sx
    R[..., 2, 0], R[..., 2, 1], R[..., 2, 2] = cy * sx * sz - sy * cz, sy * sz + cy * sx * cz, cy * cx
    return R


def euler_angles(rotations: np.ndarray) -> np.ndarray:
    """Angles (y, x, z) [rad] of rotations (..., 3, 3), with x within +-90 degrees, shape (..., 3)."""
    R = rotations
    y = np.arctan2(R[..., 0, 2], R[..., 2, 2])
    x = np.arcsin(np.clip(-R[..., 1, 2], -1.0, 1.0))
    z = np.arctan2(R[..., 1, 0], R[..., 1, 1])
    return np.stack([y, x, z], axis=-1)


@dataclass(frozen=True, kw_only=True)
class SegmentPoses:
    """Where all segments are."""

    origins: np.ndarray
    """[m], gait frame, shape (n, n_segments, 3)."""
    rotations: np.ndarray
    """Segment's axes to the gait frame, shape (n, n_segments, 3, 3)."""


def forward_kinematics(subject: SubjectModel, q: np.ndarray) -> SegmentPoses:
    """Poses of all segments for coordinates q (n, n_q) [m, rad]."""
    n, segments = len(q), subject.segments
    origins, rotations = np.empty((n, len(segments), 3)), np.empty((n, len(segments), 3, 3))
    offsets = np.array([segment.rotation_offset for segment in segments])
    joints = rotation_matrices(q[:, 3:].reshape(n, len(segments), 3) + offsets)
    for i, segment in enumerate(segments):
        if segment.parent < 0:
            origins[:, i], rotations[:, i] = q[:, :3] + segment.joint_offset, joints[:, i]
            continue
        carrier = rotations[:, segment.parent]
        origins[:, i] = origins[:, segment.parent] + carrier @ segment.joint_offset
        rotations[:, i] = carrier @ joints[:, i]
    return SegmentPoses(origins=origins, rotations=rotations)


def point_positions(
    subject: SubjectModel, points: Mapping[str, PointOnSegment], q: np.ndarray
) -> dict[str, np.ndarray]:
    """Positions [m], gait frame, shapes (n, 3), of contacts or markers for coordinates q (n, n_q)."""
    poses = forward_kinematics(subject, q)
    return {
        name: poses.origins[:, point.segment] + poses.rotations[:, point.segment] @ point.position
        for name, point in points.items()
    }


def coordinates_from_poses(subject: SubjectModel, root_origin: np.ndarray, rotations: np.ndarray) -> np.ndarray:
    """Coordinates q (n, n_q) [m, rad] that give the segments these axes.

    Args:
        subject: the tree of segments.
        root_origin: position of the root's origin, gait frame [m], shape (n, 3).
        rotations: axes of the segments in the gait frame, shape (n, n_segments, 3, 3); NaN where unknown.

    Returns:
        Angles unwrapped over time, medians within half a turn of zero; NaN where a segment or its parent is unknown.
    """
    q = np.empty((len(root_origin), subject.n_q))
    q[:, :3] = root_origin - subject.segments[0].joint_offset
    for i, segment in enumerate(subject.segments):
        joint = rotations[:, i]
        if segment.parent >= 0:
            joint = np.swapaxes(rotations[:, segment.parent], -1, -2) @ joint
        q[:, 3 + 3 * i : 6 + 3 * i] = unwrapped(euler_angles(joint) - segment.rotation_offset)
    return q


def unwrapped(angles: np.ndarray) -> np.ndarray:
    """Angles (n, k) [rad] without jumps of a turn between known frames, medians within half a turn of zero."""
    result = angles.copy()
    for column in result.T:
        # Most curves stay within half a turn of zero, where neither a jump nor another turn is possible.
        if np.nanmax(np.abs(column), initial=0.0) < 0.5 * np.pi:
            continue
        known = np.isfinite(column)
        if known.any():
            smooth = np.unwrap(column[known])
            column[known] = smooth - 2 * np.pi * np.round(np.median(smooth) / (2 * np.pi))
    return result
