"""Head, arms and trunk: welded to one body that the pelvis or a trunk joint carries."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gaitlab.multibody.anthropometry import Fractions, SegmentFractions
from gaitlab.multibody.rigid_body import RigidBody, welded


@dataclass(frozen=True, kw_only=True)
class UpperBodyShape:
    """Lengths of the upper body and where arms and head are attached, all along or beside an upright z axis."""

    lengths: Mapping[str, float]
    """Segment name to length [m]: pelvis, trunk_middle, trunk_upper, head, arm_upper, arm_lower."""
    shoulder_half_width: float
    """Shoulder joint centre to the median plane [m]."""
    shoulder_height: float
    """Above the origin of the upper trunk [m]."""
    head_height: float
    """Above the origin of the upper trunk [m]."""


def shape_from_height(fractions: Fractions, height: float) -> UpperBodyShape:
    """Mean shape for a body height [m].

    De Leva 1996: shoulder joints lie 0.0886 of the height above the xiphion (his men: trunk MIDS-MIDH 515.5 mm less
    lower and middle trunk). Half width: half of Winter's biacromial 0.259 height (2009, fig. 4.1) less 0.02.
    """
    lengths = {name: fraction.length * height for name, fraction in fractions.items()}
    return UpperBodyShape(
        lengths=lengths,
        shoulder_half_width=0.11 * height,
        shoulder_height=0.0886 * height,
        head_height=lengths["trunk_upper"],
    )


def pelvis_body(fractions: Fractions, shape: UpperBodyShape, body_mass: float) -> RigidBody:
    """The pelvis (lower trunk) alone, origin between the hips, z up."""
    return segment_body(fractions["pelvis"], shape.lengths["pelvis"], body_mass)


def trunk_body(fractions: Fractions, shape: UpperBodyShape, body_mass: float) -> RigidBody:
    """Trunk, head and hanging arms, origin on top of the pelvis, x forward, y left, z up."""
    parts = [_part(fractions, shape, body_mass, "trunk_middle", np.zeros(3))]
    chest = np.array([0.0, 0.0, shape.lengths["trunk_middle"]])
    parts.append(_part(fractions, shape, body_mass, "trunk_upper", chest))
    parts.append(_part(fractions, shape, body_mass, "head", chest + [0.0, 0.0, shape.head_height]))
    for side in (-1.0, 1.0):
        shoulder = chest + [0.0, side * shape.shoulder_half_width, shape.shoulder_height]
        elbow = shoulder - [0.0, 0.0, shape.lengths["arm_upper"]]
        parts.append(_part(fractions, shape, body_mass, "arm_upper", shoulder))
        parts.append(_part(fractions, shape, body_mass, "arm_lower", elbow))
    return welded(parts)


def segment_body(fraction: SegmentFractions, length: float, body_mass: float) -> RigidBody:
    """Mass properties of one segment in its own frame, for its length [m] and the body mass [kg]."""
    mass = fraction.mass * body_mass
    return RigidBody(
        mass=mass,
        centre_of_mass=np.array([0.0, 0.0, fraction.centre_of_mass * length]),
        inertia=fraction.inertia(mass, length),
    )


def _part(fractions: Fractions, shape: UpperBodyShape, body_mass: float, name: str, origin: np.ndarray) -> RigidBody:
    return segment_body(fractions[name], shape.lengths[name], body_mass).seen_from(np.eye(3), origin)
