"""The subject as a tree of rigid bodies."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Segment:
    """One rigid body and the joint that carries it.

    The segment's frame is obtained from its parent's by the translation `joint_offset`, then the rotations
    R_y(q_y + o_y) R_x(q_x + o_x) R_z(q_z + o_z) with `rotation_offset` o (Y'X'Z' Euler angles, thesis ch. 10).
    """

    name: str
    parent: int
    """Index of the parent segment, -1 for the root, which first translates by q_0, q_1, q_2."""
    joint_offset: np.ndarray
    """Joint centre in the parent's frame [m], shape (3,)."""
    rotation_offset: np.ndarray
    """Angles (y, x, z) that are added to the coordinates [rad], shape (3,)."""
    mass: float
    """[kg]"""
    centre_of_mass: np.ndarray
    """In the segment's frame [m], shape (3,)."""
    inertia: np.ndarray
    """About the centre of mass, segment's axes [kg*m^2], shape (3, 3)."""


@dataclass(frozen=True, kw_only=True)
class PointOnSegment:
    """A point fixed to a segment: a marker or a contact point."""

    segment: int
    position: np.ndarray
    """In the segment's frame [m], shape (3,)."""


@dataclass(frozen=True, kw_only=True)
class SubjectModel:
    """Multibody model of one person.

    Coordinates: q = (x forward, y left, z up of the pelvis origin; Y'X'Z' angles of the root; Y'X'Z' angles of each
    further segment's joint), n_q = 3 + 3 n_segments, and v = dq/dt.
    """

    name: str
    segments: tuple[Segment, ...]
    """Root first, parents before children: pelvis, right_thigh, right_shank, right_foot, left_thigh ..."""
    contacts: Mapping[str, PointOnSegment]
    """right_heel, right_toe, left_heel, left_toe."""
    markers: Mapping[str, PointOnSegment] = field(default_factory=dict[str, PointOnSegment])

    @property
    def n_q(self) -> int:
        """Number of generalised coordinates."""
        return 3 + 3 * len(self.segments)

    @property
    def mass(self) -> float:
        """Body mass [kg]."""
        return sum(s.mass for s in self.segments)
