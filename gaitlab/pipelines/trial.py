"""One walk: everything that is known about it, as values."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..clinical.cycle_average import time_normalise
from ..clinical.document import CURVES, SIDES
from ..clinical.spatiotemporal import Spatiotemporal, cycle_spatiotemporal
from ..errors import InvalidRecording
from ..inverse.conventional import ConventionalKinematics
from ..inverse.kinematics import InverseKinematics
from ..mocap.cycles import Cycle, cycles
from ..mocap.recording import Event, Recording, Side
from ..multibody.subject import SubjectModel
from ..signal.gaps import Gap
from .weights import TrialWeights

Curves = Mapping[str, Mapping[Side, tuple[np.ndarray, ...]]]
"""Curve name to side to one array of 101 samples [deg] per cycle, NaN where unknown."""


@dataclass(frozen=True, kw_only=True)
class TrialAnalysis:
    """One walk, analysed."""

    recording: Recording
    """Short gaps filled."""
    gaps: tuple[Gap, ...]
    events: tuple[Event, ...]
    cycles: Mapping[Side, tuple[Cycle, ...]]
    kinematics: ConventionalKinematics
    curves: Curves
    spatiotemporal: Mapping[Side, tuple[Spatiotemporal, ...]]
    subject: SubjectModel
    motion: InverseKinematics
    weights: TrialWeights | None
    arrays: Mapping[str, np.ndarray]
    """Contents of walk.npz; those with one row per stored frame have shape (n_frames, ...)."""
    warnings: tuple[str, ...]

    @property
    def name(self) -> str:
        """File stem."""
        return self.recording.name


def full_cycles(recording: Recording, events: tuple[Event, ...]) -> dict[Side, tuple[Cycle, ...]]:
    """Cycles of both sides; raises InvalidRecording when there is not one full stride of either."""
    found: dict[Side, tuple[Cycle, ...]] = {side: tuple(cycles(events, side)) for side in SIDES}
    if not any(found.values()):
        strikes = sum(event.kind == "foot_strike" for event in events)
        raise InvalidRecording(
            f"{recording.name}: no full stride ({strikes} foot strikes found, two of one side are needed); "
            "give a longer trial, or try --redetect-events"
        )
    return found


def cycle_curves(kinematics: ConventionalKinematics, found: Mapping[Side, tuple[Cycle, ...]], rate: float) -> Curves:
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
    recording: Recording, kinematics: ConventionalKinematics, found: Mapping[Side, tuple[Cycle, ...]]
) -> dict[Side, tuple[Spatiotemporal, ...]]:
    """Distances and times of every cycle, measured at the heel markers, or at the ankles where one is missing."""
    feet = _feet(recording, kinematics)
    return {side: tuple(cycle_spatiotemporal(cycle, feet, recording.rate) for cycle in found[side]) for side in SIDES}


def _feet(recording: Recording, kinematics: ConventionalKinematics) -> dict[Side, np.ndarray]:
    heels = {side: recording.markers.get(f"{side[0].upper()}HEE") for side in SIDES}
    present = {side: heel for side, heel in heels.items() if heel is not None and np.isfinite(heel).any()}
    return present if len(present) == 2 else {side: kinematics.joint_centres[f"{side}_ankle"] for side in SIDES}
