"""A motion-capture trial in memory, in SI units, whatever file it came from."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

Side = Literal["left", "right"]
EventKind = Literal["foot_strike", "foot_off"]
EventSource = Literal["file", "detected", "corrected"]
SoleChangeKind = Literal["foot_flat", "heel_off"]


@dataclass(frozen=True, kw_only=True)
class Event:
    """Foot strike or foot off of one side."""

    side: Side
    kind: EventKind
    time: float
    """Time [s] from the first stored frame."""
    source: EventSource


@dataclass(frozen=True, kw_only=True)
class SoleChange:
    """When a standing foot comes to lie flat, or its heel leaves the floor, as somebody marked it in the file."""

    side: Side
    kind: SoleChangeKind
    time: float
    """Time [s] from the first stored frame."""


@dataclass(frozen=True, kw_only=True)
class ForcePlate:
    """One force plate: what it measured, and where it lies in the laboratory."""

    corners: np.ndarray
    """Corners of the working surface, laboratory frame [m], shape (4, 3)."""
    force: np.ndarray
    """Force that the ground exerts on the foot, laboratory frame [N], shape (n_samples, 3)."""
    moment: np.ndarray
    """Moment of that force about the centre of the working surface, laboratory frame [N*m], shape (n_samples, 3)."""
    rate: float
    """Samples per second [Hz]."""


@dataclass(frozen=True, kw_only=True)
class Recording:
    """One trial. Laboratory frame: the file's own axes, metres, z up."""

    name: str
    """File stem."""
    sha256: str
    rate: float
    """Video frames per second [Hz]."""
    first_frame: int
    """Frames between the start of capture and the first stored frame."""
    markers: Mapping[str, np.ndarray]
    """Canonical marker name (LASI, RKNE ...) to positions [m], shape (n_frames, 3); NaN where missing."""
    model_outputs: Mapping[str, np.ndarray] = field(default_factory=dict[str, np.ndarray])
    """Stored results of other software (LHipAngles, LFEP ...), file's units, shape (n_frames, 3); NaN where missing.
    Points that are positions are in metres."""
    force_plates: tuple[ForcePlate, ...] = ()
    events: tuple[Event, ...] = ()
    sole_changes: tuple[SoleChange, ...] = ()
    """Events "Foot Flat" and "Heel Off" of the file, in time order; mostly none."""
    parameters: Mapping[str, float] = field(default_factory=dict[str, float])
    """Subject parameters in SI units: mass, height, left_leg_length, left_knee_width, left_thigh_rotation ..."""
    analog: Mapping[str, np.ndarray] = field(default_factory=dict[str, np.ndarray])
    """Analogue channels other than force plates, for instance EMG, file's units, shape (n_samples,)."""
    analog_units: Mapping[str, str] = field(default_factory=dict[str, str])
    """Label to the unit that the file states for the channel; without those that it leaves blank."""
    analog_rate: float = 0.0
    """Samples per second of `analog` [Hz]."""
    warnings: tuple[str, ...] = ()

    @property
    def n_frames(self) -> int:
        """Number of stored frames."""
        return len(next(iter(self.markers.values())))
