"""Segment inertias as Plug-in Gait applies them, to explain how its moments differ from ours.

Masses and centres of mass: Winter, Biomechanics and Motor Control of Human Movement, Table 4.1. Plug-in Gait takes the
table's radii of gyration about the proximal end and applies them about the centre of mass, and gives segments no
inertia about their long axis: an overestimate of the transverse inertia, which is why it is not our default.
"""

from collections.abc import Mapping

import numpy as np

from gaitlab.mocap.recording import Side
from gaitlab.multibody.rigid_body import RigidBody
from gaitlab.multibody.scaling import SegmentPose
from gaitlab.multibody.subject import SubjectModel

SIDES: tuple[Side, Side] = ("left", "right")
FRACTIONS = {"thigh": (0.1, 0.433, 0.540), "shank": (0.0465, 0.433, 0.528), "foot": (0.0145, 0.5, 0.690)}
"""Mass over body mass; centre of mass from the proximal end and radius of gyration over the segment's length."""


def published_bodies(subject: SubjectModel, poses: Mapping[str, SegmentPose]) -> dict[str, RigidBody]:
    """left_thigh, left_shank, left_foot ... in the frames of `poses`, z up the segment from its distal end.

    Lengths [m] are medians over the frames, to the next joint; of the foot the model's from ankle to toe marker.
    """
    return {
        f"{side}_{kind}": _body(kind, subject.mass, _length(subject, poses, side, kind))
        for side in SIDES
        for kind in FRACTIONS
    }


def _body(kind: str, mass: float, length: float) -> RigidBody:
    share, centre, radius = FRACTIONS[kind]
    across = share * mass * (radius * length) ** 2
    return RigidBody(
        mass=share * mass,
        centre_of_mass=np.array([0.0, 0.0, -centre * length]),
        inertia=np.diag([across, across, 0.0]),
    )


def _length(subject: SubjectModel, poses: Mapping[str, SegmentPose], side: Side, kind: str) -> float:
    if kind == "foot":
        return float(np.linalg.norm(subject.markers[f"{side[0].upper()}TOE"].position))
    following = {"thigh": "shank", "shank": "foot"}[kind]
    ends = poses[f"{side}_{kind}"].origin - poses[f"{side}_{following}"].origin
    return float(np.nanmedian(np.linalg.norm(ends, axis=1)))
