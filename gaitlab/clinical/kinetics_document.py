"""The part of `result.json` on forces: moments, powers, ground reactions, contacts with the plates, EMG envelopes."""

from collections.abc import Mapping

import msgspec

from ..mocap.recording import Side

MOMENT_CURVES = (
    "hip_extensor_moment",
    "hip_abductor_moment",
    "hip_external_rotator_moment",
    "knee_extensor_moment",
    "knee_abductor_moment",
    "knee_external_rotator_moment",
    "ankle_plantarflexor_moment",
    "ankle_evertor_moment",
    "ankle_external_rotator_moment",
)
"""Internal moments, named after the muscles that a positive value loads [N*m/kg]."""
POWER_CURVES = ("hip_power", "knee_power", "ankle_power")
"""Positive when the muscles generate [W/kg]."""
REACTION_CURVES = ("ground_reaction_vertical", "ground_reaction_forward", "ground_reaction_medial")
"""What the ground exerts on the foot [% of body weight]."""
UNITS: Mapping[str, str] = {
    **{name: "N*m/kg" for name in MOMENT_CURVES},
    **{name: "W/kg" for name in POWER_CURVES},
    **{name: "%BW" for name in REACTION_CURVES},
}


class CycleAverage(msgspec.Struct, frozen=True, kw_only=True):
    """One quantity over the gait cycle, 0 to 100 % in 101 samples."""

    mean: list[float | None]
    sd: list[float | None]
    n_cycles: int


class UnitCurve(msgspec.Struct, frozen=True, kw_only=True):
    """One quantity of both sides, each on its own cycle, in the stated unit."""

    unit: str
    left: CycleAverage | None = None
    right: CycleAverage | None = None


class ContactEntry(msgspec.Struct, frozen=True, kw_only=True):
    """One loading of one force plate."""

    trial: str
    plate: int
    """Counted from 1."""
    start_s: float
    end_s: float
    side: Side | None
    """Foot above the centre of pressure; null where there is none."""
    accepted: bool
    reason: str
    """Why the contact is not used; empty where it is."""


class KineticsEntry(msgspec.Struct, frozen=True, kw_only=True):
    """Kinetics over the cycles in which the ground reaction of the foot was measured throughout."""

    curves: dict[str, UnitCurve]
    """hip_extensor_moment ... ground_reaction_medial; moments are internal."""
    moments_in: str
    """Axes that the moments are expressed in, in words."""
    inertia: str
    """Where the mass properties of the segments come from."""
    contacts: list[ContactEntry]
    missing: list[str]
    """What is not there and why, sentences."""


class EmgEntry(msgspec.Struct, frozen=True, kw_only=True):
    """Envelopes of the file's electromyograms over the cycles; a label without a side is cut by both."""

    envelopes: dict[str, UnitCurve]
    """By the file's label, in the file's unit."""
    filter: str
    """How the envelope was made, in words."""
    activity: dict[str, dict[Side, list[tuple[float, float]]]] = {}
    """By label and side: start and end [%] of each part of the cycle in which the muscle is active."""
    activity_rule: str = ""
    """When it counts as active, in words."""
    muscles: dict[str, str] = {}
    """Label to the muscle that it names, as norms call it; labels that name none are absent."""
