"""The reference gait made dynamically consistent: tracked over the whole recording, on a grid twice as fine."""

from dataclasses import dataclass

import numpy as np

from ..errors import NotConverged
from ..nlp.sparse_solution import Status
from ..ocp.mechanical import ContactStage
from ..walking.contact_phases import FLAT, FREE, HEEL, TOE
from ..walking.contact_schedule import ScheduleSettings, contact_stages
from ..walking.tracking import MeasuredStride, TrackedWalk, TrackingSettings, measured_stride, track
from .demo_gait import ReferenceGait, in_contact
from .demo_patterns import GRID, SIDES, GaitPattern
from .demo_recording import RATE
from .demo_reference import recording_time

INTERVAL = GRID / 2
TORQUE_WEIGHT = 1e-3
"""Heavier than the estimator's: the truth should be a gentle walk, not the one closest to the reference."""


@dataclass(frozen=True, kw_only=True)
class TrackedRecording:
    """A walk over the whole recording."""

    pattern: GaitPattern
    walk: TrackedWalk

    @property
    def start(self) -> float:
        """Time of the first node after the right foot strike in the recording [s]."""
        return float(recording_time(self.pattern, RATE)[0])

    @property
    def stride_nodes(self) -> tuple[int, int]:
        """First and last node of the right stride in the recording."""
        first = round(-self.start / INTERVAL)
        return first, first + round(self.pattern.stride_time / INTERVAL)


def track_reference(gait: ReferenceGait) -> TrackedRecording:
    """Solve the tracking problem of the whole recording.

    Raises:
        NotConverged: The reference is too far from what is dynamically possible.
    """
    time = recording_time(gait.pattern, RATE)
    stages = pattern_stages(gait.pattern, INTERVAL)
    stride: MeasuredStride = measured_stride(gait.subject, stages, 0.0, gait.coordinates(time), RATE)
    walk = track(stride, TrackingSettings(torque_weight=TORQUE_WEIGHT, allowance=0.0))
    if walk.solution.status is not Status.SOLVED:
        raise NotConverged(f"{gait.pattern.name}: the reference gait could not be tracked: {walk.solution.status}")
    return TrackedRecording(pattern=gait.pattern, walk=walk)


def pattern_stages(pattern: GaitPattern, interval: float) -> tuple[ContactStage, ...]:
    """Stages of the whole recording as the pattern has them, cut into intervals [s]."""
    time = recording_time(pattern, RATE)
    middle = time + 0.5 / RATE
    phases = np.stack([_phases(pattern, side == "right", middle) for side in SIDES], axis=1)
    return contact_stages(phases, RATE, (0.0, (len(time) - 1) / RATE), ScheduleSettings(interval=interval))


def _phases(pattern: GaitPattern, right: bool, time: np.ndarray) -> np.ndarray:
    heel, toe = (in_contact(pattern, SIDES[0 if right else 1], part, time)[0] for part in ("heel", "toe"))
    return np.where(heel & toe, FLAT, np.where(heel, HEEL, np.where(toe, TOE, FREE)))
