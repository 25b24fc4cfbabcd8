"""One walk: everything that is known about it, as values."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..clinical.cycle_average import time_normalise
from ..clinical.document import CURVES, SIDES, CalibrationEntry
from ..clinical.spatiotemporal import Spatiotemporal, cycle_spatiotemporal
from ..inverse.conventional import ConventionalKinematics
from ..inverse.conventional_calibration import Calibration
from ..inverse.kinematics import InverseKinematics
from ..mocap.cycle import Cycle
from ..mocap.cycles import full_strides, visible_strides
from ..mocap.recording import Event, Recording, Side
from ..multibody.subject import SubjectModel
from ..signal.gaps import Gap
from .kinetics import TrialKinetics
from .weights import TrialWeights

Cycles = Mapping[Side, tuple[Cycle, ...]]
Curves = Mapping[str, Mapping[Side, tuple[np.ndarray, ...]]]
"""Curve name to side to one array of 101 samples [deg] per cycle, NaN where unknown."""


@dataclass(frozen=True, kw_only=True)
class TrialAnalysis:
    """One walk, analysed."""

    recording: Recording
    """Short gaps filled."""
    gaps: tuple[Gap, ...]
    events: tuple[Event, ...]
    cycles: Cycles
    calibration: CalibrationEntry
    constants: Calibration
    kinematics: ConventionalKinematics
    curves: Curves
    spatiotemporal: Mapping[Side, tuple[Spatiotemporal, ...]]
    subject: SubjectModel
    motion: InverseKinematics
    kinetics: TrialKinetics
    weights: TrialWeights | None
    arrays: Mapping[str, np.ndarray]
    """Contents of walk.npz; those with one row per stored frame have shape (n_frames, ...)."""
    warnings: tuple[str, ...]
    not_converged: str = ""
    """Why what was asked for did not converge, in words; empty when all is well."""

    @property
    def name(self) -> str:
        """File stem."""
        return self.recording.name


def full_cycles(recording: Recording, events: tuple[Event, ...]) -> tuple[Cycles, tuple[str, ...]]:
    """Full strides of both sides, and a warning for each with missing markers and each side without one.

    Raises:
        InvalidRecording: There is no full stride, or none has all markers.
    """
    strides = full_strides(recording.name, events)
    _, warnings = visible_strides(recording, strides)
    found: Cycles = {side: tuple(stride for stride in strides if stride.side == side) for side in SIDES}
    empty = tuple(f"no full stride of the {side} side" for side in SIDES if not found[side])
    return found, (*warnings, *empty)


def cycle_curves(kinematics: ConventionalKinematics, found: Cycles, rate: float) -> Curves:
    """The nine curves cut at the foot strikes, 101 samples [deg] each; `rate` in frames per second [Hz]."""
    return {
        curve: {
            side: tuple(
                np.degrees(time_normalise(kinematics.angles[f"{side}_{curve}"], rate, cycle)) for cycle in found[side]
            )
            for side in SIDES
        }
        for curve in CURVES
    }


def trial_spatiotemporal(
    recording: Recording, kinematics: ConventionalKinematics, found: Cycles
) -> dict[Side, tuple[Spatiotemporal, ...]]:
    """Distances and times of every cycle, measured at the heel markers, or at the ankles where one is missing."""
    feet = _feet(recording, kinematics)
    return {side: tuple(cycle_spatiotemporal(cycle, feet, recording.rate) for cycle in found[side]) for side in SIDES}


def _feet(recording: Recording, kinematics: ConventionalKinematics) -> dict[Side, np.ndarray]:
    left, right = recording.markers.get("LHEE"), recording.markers.get("RHEE")
    if left is not None and right is not None and np.isfinite(left).any() and np.isfinite(right).any():
        return {"left": left, "right": right}
    return {"left": kinematics.joint_centres["left_ankle"], "right": kinematics.joint_centres["right_ankle"]}
