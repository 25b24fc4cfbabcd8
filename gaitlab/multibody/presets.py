"""The two children of the thesis (ch. 12) as subjects, with the readings of misprints that design/numerics.md lists.

Read as printed: lengths, masses (sum 0.9604), radii, centres of mass, and the trunk's posture of Tables 12.1 and 12.7.
Read otherwise: 0.17 of Trunk U and 0.15 of Head are translations along z; the foot's offset of about -1.57 belongs to
the flexion axis y, the one with the tibial torsion (its sign mirrors between the sides, as toe-out does) to x, which
that rotation turns upright, the remaining one to z.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gaitlab.multibody.anthropometry import PRINTED, Fractions, with_right_shank_as_printed
from gaitlab.multibody.kinematics import rotation_matrices
from gaitlab.multibody.rigid_body import RigidBody, welded
from gaitlab.multibody.subject import PointOnSegment, Segment, SubjectModel
from gaitlab.multibody.upper_body import UpperBodyShape, pelvis_body, segment_body, trunk_body

TRUNK_LENGTHS = {
    "pelvis": 0.135,
    "trunk_middle": 0.17,
    "trunk_upper": 0.17,
    "head": 0.15,
    "arm_upper": 0.17,
    "arm_lower": 0.17,
}
"""Tables 12.6 and 12.10 [m]."""

ANKLE_HEIGHT = 0.039
"""Of the body height (Winter 2009, fig. 4.1): the thesis has no heel, ours lies this far below the ankle."""

HEEL_BEHIND_ANKLE = 0.25
"""Of the foot's length from ankle to toe: the heel lies this far behind the ankle."""


@dataclass(frozen=True, kw_only=True)
class _Child:
    """What Tables 12.1-12.3 and 12.6, or 12.7-12.10, print for one child."""

    name: str
    mass: float
    height: float
    hip_half_width: float
    trunk_angles: tuple[float, float, float]
    lengths: Mapping[str, float]
    foot_offsets: Mapping[str, tuple[float, float, float]]


CP_CHILD = _Child(
    name="thesis_cp_child",
    mass=39.2,
    height=1.46,
    hip_half_width=0.0680,
    trunk_angles=(0.1002, -0.05, 0.0),
    lengths={
        "right_thigh": 0.3545,
        "right_shank": 0.3990,
        "right_foot": 0.1405,
        "left_thigh": 0.3616,
        "left_shank": 0.3792,
        "left_foot": 0.1175,
    },
    foot_offsets={"right": (-1.5133, -0.5932, 0.1011), "left": (-1.5463, 0.5666, -0.1843)},
)

# Table 12.7 places the left ankle at -0.3764 although Table 12.10 gives the left shank 0.3792, the value of the other
# child: the frame's own number is taken, as it is what moves.
ABLE_BODIED_CHILD = _Child(
    name="thesis_able_bodied_child",
    mass=51.0,
    height=1.56,
    hip_half_width=0.0720,
    trunk_angles=(0.1200, -0.05, 0.0),
    lengths={
        "right_thigh": 0.3877,
        "right_shank": 0.3868,
        "right_foot": 0.1344,
        "left_thigh": 0.3972,
        "left_shank": 0.3764,
        "left_foot": 0.1314,
    },
    foot_offsets={"right": (-1.4629, -0.4523, 0.0395), "left": (-1.4178, 0.3904, 0.0285)},
)


def thesis_cp_child(trunk_joint: bool = False) -> SubjectModel:
    """The child with cerebral palsy, 39.2 kg, 1.46 m: 24 coordinates, 27 with a trunk joint.

    Contacts: `right_toe` and `left_toe` are the thesis's point feet, `right_heel` and `left_heel` are ours.
    """
    return _build(CP_CHILD, trunk_joint)


def thesis_able_bodied_child(trunk_joint: bool = False) -> SubjectModel:
    """The able-bodied child, 51 kg, 1.56 m: 24 coordinates, 27 with a trunk joint; contacts as `thesis_cp_child`."""
    return _build(ABLE_BODIED_CHILD, trunk_joint)


def _build(child: _Child, trunk_joint: bool) -> SubjectModel:
    shape = UpperBodyShape(lengths=TRUNK_LENGTHS, shoulder_half_width=0.068, shoulder_height=0.17, head_height=0.15)
    pelvis, trunk = pelvis_body(PRINTED, shape, child.mass), trunk_body(PRINTED, shape, child.mass)
    place, angles = np.array([0.0, 0.0, TRUNK_LENGTHS["pelvis"]]), np.array(child.trunk_angles)
    if not trunk_joint:
        pelvis = welded([pelvis, trunk.seen_from(rotation_matrices(angles), place)])
    segments = [_segment("pelvis", -1, pelvis)]
    for side, sign in (("right", -1.0), ("left", 1.0)):
        segments += _leg(child, side, np.array([0.0, sign * child.hip_half_width, 0.0]), len(segments))
    if trunk_joint:
        segments.append(_segment("trunk", 0, trunk, place, angles))
    return SubjectModel(name=child.name, segments=tuple(segments), contacts=_contacts(child))


def _leg(child: _Child, side: str, hip: np.ndarray, first: int) -> list[Segment]:
    fractions: Fractions = with_right_shank_as_printed(PRINTED) if side == "right" else PRINTED
    bodies = [
        segment_body(fractions[part], child.lengths[f"{side}_{part}"], child.mass)
        for part in ("thigh", "shank", "foot")
    ]
    knee = np.array([0.0, 0.0, -child.lengths[f"{side}_thigh"]])
    ankle = np.array([0.0, 0.0, -child.lengths[f"{side}_shank"]])
    return [
        _segment(f"{side}_thigh", 0, bodies[0], hip),
        _segment(f"{side}_shank", first, bodies[1], knee),
        _segment(f"{side}_foot", first + 1, bodies[2], ankle, np.array(child.foot_offsets[side])),
    ]


def _segment(
    name: str, parent: int, body: RigidBody, place: np.ndarray | None = None, angles: np.ndarray | None = None
) -> Segment:
    return Segment(
        name=name,
        parent=parent,
        joint_offset=np.zeros(3) if place is None else place,
        rotation_offset=np.zeros(3) if angles is None else angles,
        mass=body.mass,
        centre_of_mass=body.centre_of_mass,
        inertia=body.inertia,
    )


def _contacts(child: _Child) -> dict[str, PointOnSegment]:
    points: dict[str, PointOnSegment] = {}
    for side, segment in (("right", 3), ("left", 6)):
        length = child.lengths[f"{side}_foot"]
        heel = np.array([-ANKLE_HEIGHT * child.height, 0.0, HEEL_BEHIND_ANKLE * length])
        points[f"{side}_heel"] = PointOnSegment(segment=segment, position=heel)
        points[f"{side}_toe"] = PointOnSegment(segment=segment, position=np.array([0.0, 0.0, -length]))
    return points
