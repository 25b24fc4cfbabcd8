"""A person's model from a static trial: segment lengths, axes, contact points, marker places and inertias.

Works on what the direct model found, the static's or, without a static, the walk's own frames.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gaitlab.errors import InvalidSubject
from gaitlab.multibody.anthropometry import TABLES, AnthropometryName, total_mass_fraction
from gaitlab.multibody.contact import flat_frames, floor_height, sole_points
from gaitlab.multibody.marker_set import SEGMENT_OF_MARKER
from gaitlab.multibody.rigid_body import RigidBody, welded
from gaitlab.multibody.subject import PointOnSegment, Segment, SubjectModel
from gaitlab.multibody.upper_body import pelvis_body, segment_body, shape_from_height, trunk_body

SIDES = ("right", "left")
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, kw_only=True)
class MeasuredBody:
    """A trial as the direct model sees it, in any frame with z up. NaN where unknown."""

    joint_centres: Mapping[str, np.ndarray]
    """right_hip, right_knee, right_ankle, left_hip ... [m], shapes (n, 3)."""
    axes: Mapping[str, np.ndarray]
    """pelvis, right_thigh, right_shank, right_foot ...: columns forward, left, up, shapes (n, 3, 3)."""
    markers: Mapping[str, np.ndarray]
    """Canonical name to positions [m], shapes (n, 3)."""


@dataclass(frozen=True, kw_only=True)
class SubjectSettings:
    """Choices in building the model."""

    anthropometry: AnthropometryName = "corrected"
    """Table of masses, centres of mass and radii of gyration."""
    trunk_joint: bool = False
    """False: head, arms and trunk rigid on the pelvis, 24 coordinates as in the thesis. True: 27 with a trunk joint."""
    trunk_direction: np.ndarray | None = None
    """Direction of a rigid trunk in the pelvis's axes, shape (3,); None: that of the trial the model is built from.
    People stand with another pelvic tilt than they walk with: give `trunk_direction` of the walk."""
    floor_height: float | None = None
    """Height of the floor [m] in the frame of the measurement; None: see `contact.floor_height`."""


@dataclass(frozen=True, kw_only=True)
class SegmentPose:
    """One segment over time."""

    origin: np.ndarray
    """[m], shape (n, 3)."""
    rotation: np.ndarray
    """Segment's axes in the frame of the measurement, shape (n, 3, 3)."""

    def local(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 3) [m] in the segment's frame, shape (n, 3)."""
        return (np.swapaxes(self.rotation, 1, 2) @ (points - self.origin)[..., None])[..., 0]


def segment_poses(body: MeasuredBody) -> dict[str, SegmentPose]:
    """Poses of pelvis, right_thigh, right_shank, right_foot, left_thigh ... with the axes of `SubjectModel`.

    Pelvis: between the hips, the direct model's axes. Thigh and shank: z from the distal to the proximal joint centre,
    y next to the direct model's. Foot: at the ankle, z from the toe marker to the ankle, y next to the direct model's.
    """
    centres = body.joint_centres
    middle = (centres["right_hip"] + centres["left_hip"]) / 2
    poses = {"pelvis": SegmentPose(origin=middle, rotation=body.axes["pelvis"])}
    for side in SIDES:
        toe = body.markers[f"{side[0].upper()}TOE"]
        chain = [*(centres[f"{side}_{joint}"] for joint in ("hip", "knee", "ankle")), toe]
        for kind, proximal, distal in zip(("thigh", "shank", "foot"), chain[:-1], chain[1:], strict=True):
            rotation = _axes_along(proximal - distal, body.axes[f"{side}_{kind}"][:, :, 1])
            poses[f"{side}_{kind}"] = SegmentPose(origin=proximal, rotation=rotation)
    return poses


def _axes_along(z: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Axes with z along the first vector (n, 3) and y as near as possible to the second, shape (n, 3, 3)."""
    z = z / np.linalg.norm(z, axis=1, keepdims=True)
    x = np.cross(left, z)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, np.cross(z, x), z], axis=2)


def build_subject(
    body: MeasuredBody, mass: float, height: float, name: str = "subject", settings: SubjectSettings | None = None
) -> SubjectModel:
    """The person's model; joint offsets, contact points and markers are medians over the frames.

    Args:
        body: static trial, or the walk itself.
        mass: body mass [kg].
        height: body height [m].
        name: of the model.
        settings: preset of the trunk, table of inertias (its masses scaled to add up), height of the floor.

    Raises:
        InvalidSubject: mass or height are impossible, or no frame shows a joint.
    """
    settings = settings or SubjectSettings()
    _check(mass, height)
    poses = segment_poses(body)
    fractions = TABLES[settings.anthropometry]
    mass = mass / total_mass_fraction(fractions)
    shape = shape_from_height(fractions, height)
    pelvis, trunk = pelvis_body(fractions, shape, mass), trunk_body(fractions, shape, mass)
    given = None if settings.trunk_joint else settings.trunk_direction
    upright = _axes_along((trunk_direction(body) if given is None else given)[None], np.array([[0.0, 1.0, 0.0]]))[0]
    trunk_joint = upright @ np.array([0.0, 0.0, shape.lengths["pelvis"]])
    pelvis, trunk = pelvis.seen_from(upright, np.zeros(3)), trunk.seen_from(upright, np.zeros(3))
    if not settings.trunk_joint:
        pelvis = welded([pelvis, trunk.seen_from(np.eye(3), trunk_joint)])
    segments = [_segment("pelvis", -1, pelvis, np.zeros(3), np.zeros(3))]
    for side in SIDES:
        bodies = [segment_body(fractions[k], _length(body, side, k), mass) for k in ("thigh", "shank", "foot")]
        segments += _leg(body, poses, side, bodies, len(segments))
    if settings.trunk_joint:
        segments.append(_segment("trunk", 0, trunk, trunk_joint, np.zeros(3)))
        pelvis_pose = poses["pelvis"]
        origin = pelvis_pose.origin + pelvis_pose.rotation @ trunk_joint
        poses["trunk"] = SegmentPose(origin=origin, rotation=pelvis_pose.rotation)
    names = [segment.name for segment in segments]
    return SubjectModel(
        name=name,
        segments=tuple(segments),
        contacts=_contacts(body, poses, names, settings.floor_height),
        markers=_markers(body, poses, names),
    )


def _check(mass: float, height: float) -> None:
    if not 3.0 <= mass <= 300.0:
        raise InvalidSubject(f"Body mass {mass:g} kg is impossible; give one between 3 and 300 kg with --mass.")
    if not 0.4 <= height <= 2.6:
        raise InvalidSubject(f"Body height {height:g} m is impossible; give one between 0.4 and 2.6 m with --height.")


def trunk_direction(body: MeasuredBody) -> np.ndarray:
    """Typical direction of the trunk in the pelvis's axes, shape (3,).

    From between the hips to between C7 and CLAV where these markers are, else the vertical.
    """
    pelvis = segment_poses(body)["pelvis"]
    ends = [body.markers[name] for name in ("C7", "CLAV") if name in body.markers]
    along = (ends[0] + ends[1]) / 2 - pelvis.origin if len(ends) == 2 else np.broadcast_to(UP, pelvis.origin.shape)
    local = (np.swapaxes(pelvis.rotation, 1, 2) @ along[..., None])[..., 0]
    if not np.isfinite(local).all(axis=1).any():
        local = np.swapaxes(pelvis.rotation, 1, 2) @ UP
    direction = _typical(local, "the pelvis")
    return direction / np.linalg.norm(direction)


def _typical(values: np.ndarray, what: str) -> np.ndarray:
    """Median over the known frames of values (n, k)."""
    known = np.isfinite(values).all(axis=1)
    if not known.any():
        raise InvalidSubject(f"No frame shows {what}; label its markers or choose another trial for the subject.")
    return np.median(values[known], axis=0)


def _length(body: MeasuredBody, side: str, kind: str) -> float:
    centres = body.joint_centres
    ends = {
        "thigh": (centres[f"{side}_hip"], centres[f"{side}_knee"]),
        "shank": (centres[f"{side}_knee"], centres[f"{side}_ankle"]),
        "foot": (centres[f"{side}_ankle"], body.markers[f"{side[0].upper()}TOE"]),
    }
    proximal, distal = ends[kind]
    lengths = np.linalg.norm(proximal - distal, axis=1)
    return float(_typical(lengths[:, None], f"the {side} {kind}")[0])


def _leg(
    body: MeasuredBody, poses: Mapping[str, SegmentPose], side: str, bodies: list[RigidBody], first: int
) -> list[Segment]:
    hip = _typical(poses["pelvis"].local(body.joint_centres[f"{side}_hip"]), f"the {side} hip")
    knee = np.array([0.0, 0.0, -_length(body, side, "thigh")])
    ankle = np.array([0.0, 0.0, -_length(body, side, "shank")])
    neutral = np.array([_neutral_ankle(body, poses[f"{side}_foot"], side), 0.0, 0.0])
    return [
        _segment(f"{side}_thigh", 0, bodies[0], hip, np.zeros(3)),
        _segment(f"{side}_shank", first, bodies[1], knee, np.zeros(3)),
        _segment(f"{side}_foot", first + 1, bodies[2], ankle, neutral),
    ]


def _neutral_ankle(body: MeasuredBody, foot: SegmentPose, side: str) -> float:
    """Rotation about y [rad] of the foot's axes on a vertical shank when the sole is flat: about -1.57 + 0.3."""
    flat = flat_frames(body.markers, side)
    rise = _typical(foot.rotation[flat, 2, 2][:, None], f"the {side} foot flat on the floor")[0]
    return float(np.arcsin(rise) - np.pi / 2)


def _segment(name: str, parent: int, body: RigidBody, place: np.ndarray, angles: np.ndarray) -> Segment:
    return Segment(
        name=name,
        parent=parent,
        joint_offset=place,
        rotation_offset=angles,
        mass=body.mass,
        centre_of_mass=body.centre_of_mass,
        inertia=body.inertia,
    )


def _contacts(
    body: MeasuredBody, poses: Mapping[str, SegmentPose], names: list[str], floor: float | None
) -> dict[str, PointOnSegment]:
    """Heel and toe of both feet: their markers, dropped to the floor in the frames where the foot is flat."""
    points: dict[str, PointOnSegment] = {}
    floor = floor_height(body.markers) if floor is None else floor
    for side in SIDES:
        foot, flat = poses[f"{side}_foot"], flat_frames(body.markers, side)
        for part, on_floor in sole_points(body.markers, side, floor).items():
            local = _typical(foot.local(on_floor)[flat], f"the {side} {part} on the floor")
            points[f"{side}_{part}"] = PointOnSegment(segment=names.index(f"{side}_foot"), position=local)
    return points


def _markers(body: MeasuredBody, poses: Mapping[str, SegmentPose], names: list[str]) -> dict[str, PointOnSegment]:
    """Every marker whose segment the model has, at its median place; markers that were never seen are left out."""
    points: dict[str, PointOnSegment] = {}
    for marker, positions in body.markers.items():
        owner = SEGMENT_OF_MARKER.get(marker)
        if owner is None or owner not in names:
            continue
        local = poses[owner].local(positions)
        if np.isfinite(local).all(axis=1).any():
            place = _typical(local, f"marker {marker}")
            points[marker] = PointOnSegment(segment=names.index(owner), position=place)
    return points
