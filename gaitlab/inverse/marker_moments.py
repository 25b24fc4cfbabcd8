"""Sum of squared marker distances of a rigid-body tree, its gradient and Gauss-Newton matrix, for many frames at once.

A marker enters only through moments of its segment's cloud (weights w, local points p, measured points y): the sums of
w, w p, w p p', w y, w y p' and w (|p|^2 + |y|^2). The Gauss-Newton matrix is then the joint-space inertia matrix of a
mechanism with masses w at the points p (composite rigid bodies, Featherstone 2008, ch. 6), at a cost that does not
depend on the number of markers. Twists (v, omega) are taken at the root's origin.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gaitlab.multibody.kinematics import SegmentPoses, forward_kinematics
from gaitlab.multibody.subject import PointOnSegment, SubjectModel
from gaitlab.signal.runs import valid_rows


@dataclass(frozen=True, kw_only=True)
class MarkerMoments:
    """Moments of every segment's markers, per frame."""

    weight: np.ndarray
    """Sum of w, shape (n, n_segments)."""
    first: np.ndarray
    """Sum of w p [m], shape (n, n_segments, 3)."""
    second: np.ndarray
    """Sum of w p p' [m^2], shape (n, n_segments, 3, 3)."""
    measured: np.ndarray
    """Sum of w y [m], shape (n, n_segments, 3)."""
    mixed: np.ndarray
    """Sum of w y p' [m^2], shape (n, n_segments, 3, 3)."""
    square: np.ndarray
    """Sum of w (|p|^2 + |y|^2) over all segments, what the cost has besides terms of the pose [m^2], shape (n,)."""


def marker_moments(
    subject: SubjectModel,
    points: Mapping[str, PointOnSegment],
    measured: Mapping[str, np.ndarray],
    weights: Mapping[str, float],
) -> MarkerMoments:
    """Moments of the measured points (n, 3) [m] that the subject has; missing ones (NaN) count nothing."""
    names = [name for name in measured if name in points]
    n, n_segments = len(next(iter(measured.values()))), len(subject.segments)
    y = np.stack([measured[name] for name in names], axis=1)  # (n, m, 3)
    seen = np.stack([valid_rows(measured[name]) for name in names], axis=1)
    y = np.where(seen[:, :, None], y, 0.0)
    w = seen * np.array([weights.get(name, 1.0) for name in names])
    p = np.array([points[name].position for name in names])
    owner = np.array([points[name].segment for name in names])
    moments = MarkerMoments(
        weight=np.zeros((n, n_segments)),
        first=np.zeros((n, n_segments, 3)),
        second=np.zeros((n, n_segments, 3, 3)),
        measured=np.zeros((n, n_segments, 3)),
        mixed=np.zeros((n, n_segments, 3, 3)),
        square=(w * ((y**2).sum(axis=2) + (p**2).sum(axis=1))).sum(axis=1),
    )
    for s in range(n_segments):
        own = owner == s
        ws, ps, wy = w[:, own], p[own], w[:, own, None] * y[:, own]
        moments.weight[:, s] = ws.sum(axis=1)
        moments.first[:, s] = ws @ ps
        moments.second[:, s] = (ws @ (ps[:, :, None] * ps[:, None, :]).reshape(-1, 9)).reshape(n, 3, 3)
        moments.measured[:, s] = wy.sum(axis=1)
        moments.mixed[:, s] = np.swapaxes(wy, 1, 2) @ ps
    return moments


@dataclass(frozen=True, kw_only=True)
class Slope:
    """Cost f per frame and half its gradient."""

    cost: np.ndarray
    """Sum of w |x + R p - y|^2 [m^2], shape (n,)."""
    gradient: np.ndarray
    """J'W r, shape (n, n_q)."""
    poses: SegmentPoses
    twists: np.ndarray
    """Twist (v, omega) at the root's origin per unit rate of each coordinate, shape (n, 6, n_q)."""


def marker_slope(subject: SubjectModel, moments: MarkerMoments, q: np.ndarray) -> Slope:
    """Cost and gradient at coordinates q (n, n_q)."""
    poses = forward_kinematics(subject, q)
    twists = _joint_twists(subject, poses, q)
    force, cost = _segment_forces(moments, poses)
    force = _carried(subject, force)
    gradient = (twists * np.swapaxes(force[:, _owners(subject)], 1, 2)).sum(axis=1)
    return Slope(cost=cost, gradient=gradient, poses=poses, twists=twists)


def gauss_newton_matrix(subject: SubjectModel, moments: MarkerMoments, slope: Slope) -> np.ndarray:
    """J'WJ where the slope was taken, shape (n, n_q, n_q)."""
    inertia = _carried(subject, _segment_inertias(moments, slope.poses))
    twists, owner = slope.twists, _owners(subject)
    n, _, n_q = twists.shape
    columns = np.moveaxis(twists.reshape(n, 6, -1, 3), 2, 1)  # (n, 1 + n_segments, 6, 3)
    carried = inertia[:, owner[::3]] @ columns
    product = np.swapaxes(twists, 1, 2) @ np.moveaxis(carried, 1, 2).reshape(n, 6, n_q)
    above = _moves(subject)[:, owner]
    return np.where(above, product, np.swapaxes(product, 1, 2) * above.T)


def _carried(subject: SubjectModel, values: np.ndarray) -> np.ndarray:
    """Sum over each segment and all that it carries, shape (n, n_segments, ...)."""
    below = _moves(subject)[3:].reshape(len(subject.segments), 3, -1)[:, 0].astype(float)
    return (below @ values.reshape(*values.shape[:2], -1)).reshape(values.shape)


def _owners(subject: SubjectModel) -> np.ndarray:
    """Index of the segment whose joint each coordinate belongs to, shape (n_q,)."""
    return np.repeat([0, *range(len(subject.segments))], 3)


def _moves(subject: SubjectModel) -> np.ndarray:
    """Which coordinate moves which segment, shape (n_q, n_segments)."""
    owner = _owners(subject)
    moves = np.zeros((subject.n_q, len(subject.segments)), dtype=bool)
    for s, segment in enumerate(subject.segments):
        moves[:, s] = (owner == s) | (moves[:, segment.parent] if segment.parent >= 0 else False)
    return moves


def _joint_twists(subject: SubjectModel, poses: SegmentPoses, q: np.ndarray) -> np.ndarray:
    """Twist (v, omega) at the root's origin per unit rate of each coordinate, shape (n, 6, n_q)."""
    n, n_q = q.shape
    twists = np.zeros((n, 6, n_q))
    twists[:, :3, :3] = np.eye(3)
    for s, segment in enumerate(subject.segments):
        carrier = np.broadcast_to(np.eye(3), (n, 3, 3)) if segment.parent < 0 else poses.rotations[:, segment.parent]
        angle = q[:, 3 + 3 * s] + segment.rotation_offset[0]
        axes = np.empty((n, 3, 3))
        axes[:, 0] = carrier[:, :, 1]
        axes[:, 1] = np.cos(angle)[:, None] * carrier[:, :, 0] - np.sin(angle)[:, None] * carrier[:, :, 2]
        axes[:, 2] = poses.rotations[:, s, :, 2]
        arm = poses.origins[:, s] - poses.origins[:, 0]
        columns = slice(3 + 3 * s, 6 + 3 * s)
        twists[:, 3:, columns] = np.swapaxes(axes, 1, 2)
        twists[:, :3, columns] = np.swapaxes(axes @ _skew(-arm), 1, 2)
    return twists


def _segment_forces(moments: MarkerMoments, poses: SegmentPoses) -> tuple[np.ndarray, np.ndarray]:
    """Generalised force (n, n_segments, 6) of every segment's markers at the root's origin, and the cost (n,)."""
    x, R, w = poses.origins, poses.rotations, moments.weight[..., None]
    root = x[:, :1]
    turned = (R @ moments.first[..., None])[..., 0]
    missing = turned - moments.measured
    residual = w * x + missing
    pose_terms = (x * (residual + missing)).sum((-2, -1)) - 2 * (R * moments.mixed).sum((-3, -2, -1))
    h = w * (x - root) + turned
    M = moments.mixed @ np.swapaxes(R, -1, -2) + _outer(moments.measured, x - root) - _outer(root, h)
    axial = np.stack([M[..., 2, 1] - M[..., 1, 2], M[..., 0, 2] - M[..., 2, 0], M[..., 1, 0] - M[..., 0, 1]], axis=-1)
    return np.concatenate([residual, -axial], axis=-1), moments.square + pose_terms


def _segment_inertias(moments: MarkerMoments, poses: SegmentPoses) -> np.ndarray:
    """Inertia of every segment's markers at the root's origin, shape (n, n_segments, 6, 6)."""
    R, w = poses.rotations, moments.weight[..., None]
    d = poses.origins - poses.origins[:, :1]
    turned = (R @ moments.first[..., None])[..., 0]
    h = w * d + turned
    cross = _outer(turned, d)
    Q = R @ moments.second @ np.swapaxes(R, -1, -2) + cross + np.swapaxes(cross, -1, -2) + w[..., None] * _outer(d, d)
    inertia = np.zeros((*h.shape[:2], 6, 6))
    inertia[..., [0, 1, 2], [0, 1, 2]] = w
    skew = _skew(h)
    inertia[..., :3, 3:], inertia[..., 3:, :3] = -skew, skew
    inertia[..., 3:, 3:] = -Q
    inertia[..., [3, 4, 5], [3, 4, 5]] += np.trace(Q, axis1=-2, axis2=-1)[..., None]
    return inertia


def _outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., :, None] * b[..., None, :]


def _skew(h: np.ndarray) -> np.ndarray:
    result = np.zeros((*h.shape, 3))
    x, y, z = h[..., 0], h[..., 1], h[..., 2]
    result[..., 0, 1], result[..., 0, 2], result[..., 1, 2] = -z, y, -x
    result[..., 1, 0], result[..., 2, 0], result[..., 2, 1] = z, -y, x
    return result
