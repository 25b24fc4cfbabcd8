"""From measured coordinates to the weights of the criteria: the seam between gait analysis and optimal control."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..clinical.document import WeightsEntry
from ..errors import ProblemError
from ..mocap.recording import Event, Recording
from ..multibody.subject import SubjectModel
from .progress import Progress


@dataclass(frozen=True, kw_only=True)
class WeightsRequest:
    """One walk, ready for inverse optimal control."""

    recording: Recording
    """Short gaps filled; markers and plates in the laboratory frame."""
    events: tuple[Event, ...]
    subject: SubjectModel
    q: np.ndarray
    """Measured coordinates, gait frame [m, rad], shape (n_frames, n_q); NaN where markers are missing."""
    heading: float
    """Direction of the gait frame's x axis in the laboratory [rad]."""
    criteria: tuple[str, ...]
    seed: int


@dataclass(frozen=True, kw_only=True)
class TrialWeights:
    """What inverse optimal control found in one walk."""

    entry: WeightsEntry
    arrays: Mapping[str, np.ndarray]
    """q_optimal, tau_optimal, forces_optimal ... for walk.npz, shape (n_frames, ...), NaN outside the strides."""
    warnings: tuple[str, ...] = ()


def identify_weights(request: WeightsRequest, progress: Progress) -> TrialWeights:
    """Tracking, continuation and weights of one walk."""
    del progress
    raise ProblemError(f"{request.recording.name}: the weights cannot be computed yet; ask for --no-weights")
