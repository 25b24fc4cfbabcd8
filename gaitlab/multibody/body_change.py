r"""A changed body: longer or heavier segments, twisted bones.

A segment that is stretched by a factor f along a direction d takes its points to D r with D = 1 + (f - 1) d d', and
its second moments of mass E = int r r' dm to D E D (same mass). Markers and contact points move with it.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from .subject import PointOnSegment, Segment, SubjectModel

ALONG = np.array([0.0, 0.0, 1.0])
"""Long axis of thigh and shank."""


def stretched(subject: SubjectModel, name: str, factor: float) -> SubjectModel:
    """The subject with one segment longer by a factor, thigh and shank along their axis, the foot along its sole."""
    index = _index(subject, name)
    direction = _sole(subject, name) if name.endswith("foot") else ALONG
    D = np.eye(3) + (factor - 1.0) * np.outer(direction, direction)

    def moved(point: PointOnSegment) -> PointOnSegment:
        return replace(point, position=D @ point.position) if point.segment == index else point

    segments = [replace(s, joint_offset=D @ s.joint_offset) if s.parent == index else s for s in subject.segments]
    own = segments[index]
    second = D @ (0.5 * np.trace(own.inertia) * np.eye(3) - own.inertia) @ D
    inertia = np.trace(second) * np.eye(3) - second
    segments[index] = replace(own, centre_of_mass=D @ own.centre_of_mass, inertia=inertia)
    return replace(
        subject,
        segments=tuple(segments),
        contacts={key: moved(point) for key, point in subject.contacts.items()},
        markers={key: moved(point) for key, point in subject.markers.items()},
    )


def heavier(subject: SubjectModel, name: str, factor: float) -> SubjectModel:
    """The subject with the mass and inertia of one segment multiplied by a factor."""
    return _with(subject, name, lambda s: replace(s, mass=factor * s.mass, inertia=factor * s.inertia))


def twisted(subject: SubjectModel, name: str, angle: float) -> SubjectModel:
    """The subject with one segment turned about its long axis against the joint that carries it, by an angle [rad].

    With the same coordinates the joint above is as before, and everything below is turned.
    """
    turn = np.array([0.0, 0.0, angle])
    return _with(subject, name, lambda s: replace(s, rotation_offset=s.rotation_offset + turn))


def segment_length(subject: SubjectModel, name: str) -> float:
    """Length of a segment [m]: to the joint below, or from heel to toe."""
    if name.endswith("foot"):
        return float(np.linalg.norm(_heel_to_toe(subject, name)))
    index = _index(subject, name)
    return next(float(np.linalg.norm(s.joint_offset)) for s in subject.segments if s.parent == index)


def _index(subject: SubjectModel, name: str) -> int:
    return [segment.name for segment in subject.segments].index(name)


def _with(subject: SubjectModel, name: str, change: Callable[[Segment], Segment]) -> SubjectModel:
    segments = tuple(change(s) if s.name == name else s for s in subject.segments)
    return replace(subject, segments=segments)


def _heel_to_toe(subject: SubjectModel, name: str) -> np.ndarray:
    side = name.partition("_")[0]
    return subject.contacts[f"{side}_toe"].position - subject.contacts[f"{side}_heel"].position


def _sole(subject: SubjectModel, name: str) -> np.ndarray:
    along = _heel_to_toe(subject, name)
    return along / np.linalg.norm(along)
