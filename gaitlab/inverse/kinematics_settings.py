"""Choices of the whole-model inverse kinematics."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from gaitlab.multibody.subject import SubjectModel

WIDE = (-np.inf, np.inf)
JointRange = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
"""Lowest and highest coordinate about y, x and z [rad]."""

JOINT_RANGES: Mapping[str, JointRange] = {
    "pelvis": ((-1.2, 1.2), (-1.2, 1.2), WIDE),
    "thigh": ((-2.4, 1.0), (-1.0, 1.0), (-1.3, 1.3)),
    "shank": ((-0.5, 2.6), (-0.6, 0.6), (-1.0, 1.0)),
    "foot": ((-1.0, 1.4), (-1.2, 1.2), (-1.0, 1.0)),
    "trunk": ((-1.2, 1.2), (-1.0, 1.0), (-1.2, 1.2)),
}
"""Generous anatomical ranges by the last word of a segment's name; x stays away from the Euler singularity at 1.57.
Hip flexion is -y, knee flexion +y, ankle dorsiflexion -y."""


@dataclass(frozen=True, kw_only=True)
class InverseKinematicsSettings:
    """What weighs how much."""

    cut_off: float = 8.0
    """Of the smoothing [Hz]; numerics.md used 8 Hz on the markers. 0 switches smoothing off."""
    agility: float | None = None
    """Standard deviation of a marker's coordinate [m] by that of the accelerations [1/s^2 or m/s^2]: what it is for a
    smoothing that knows both, in place of `cut_off`. Coordinates that markers hardly see are smoothed more."""
    marker_weights: Mapping[str, float] = field(default_factory=dict[str, float])
    """Marker name to weight, 1 where not named."""
    joint_centre_weight: float = 1.0
    """Weight of each given joint centre beside the markers."""
    joint_ranges: Mapping[str, JointRange] = field(default_factory=lambda: JOINT_RANGES)
    prior_lever: float = 0.02
    """Angles are held to the start as by one marker at this distance from the axis [m]."""
    outlier: float = 0.06
    """A marker farther than this from the model [m] is left out of that frame."""
    distance_tolerance: float = 0.03
    """A marker whose distances to its segment's others differ by more than this [m] is left out of the trial."""
    start_tolerance: float = 0.04
    """A marker whose median distance from the model is more than this at the given start [m] is left out, too."""
    longest_gap: float = 0.1
    """Longest time without enough markers on a segment that is bridged [s]."""
    limit_weight: float = 100.0
    """Weight of leaving a joint's range, multiple of the coordinate's own weight in the markers' distances."""
    tolerance: float = 1e-3
    """Stop when no coordinate moved more than this [m, rad]; what is left is a fraction of it."""
    max_iterations: int = 60

    def limits(self, subject: SubjectModel) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates [m, rad], shapes (n_q,)."""
        kinds = [segment.name.rpartition("_")[2] for segment in subject.segments]
        ranges = [WIDE] * 3 + [pair for kind in kinds for pair in self.joint_ranges.get(kind, (WIDE,) * 3)]
        return np.array([low for low, _ in ranges]), np.array([high for _, high in ranges])
