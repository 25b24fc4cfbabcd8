"""Calibration of the conventional gait model: body measurements and, from a static trial, marker offsets."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gaitlab.errors import InvalidSubject
from gaitlab.inverse.conventional_calibration import (
    SIDES,
    Calibration,
    CalibrationMethod,
    SideCalibration,
    side_lengths,
)
from gaitlab.inverse.static_offsets import OFFSETS, StaticLeg, measure_offsets
from gaitlab.inverse.static_parameters import body_measurements
from gaitlab.mocap.recording import Recording, Side

FootFlat = bool | Literal["auto"]

NEEDED = ("leg_length", "knee_width", "ankle_width", "asis_trochanter")
WORTH_A_WARNING = np.radians(1.0)  # a smaller difference of offsets cannot be seen in a curve


@dataclass(frozen=True, kw_only=True)
class CalibrationSettings:
    """Choices of the calibration."""

    offsets: Literal["static", "file"] = "static"
    """Whether the offsets are computed from the static trial or taken from the file; the other source is used where the
    chosen one has nothing, and both are compared where both exist."""
    method: CalibrationMethod | Literal["auto"] = "auto"
    """How the knee axis is found in the static; "auto" looks which markers there are."""
    left_foot_flat: FootFlat = "auto"
    """Whether the left sole lies flat on the floor in the static. "auto" takes what fits the offsets stored in the
    file, else the file's own setting, else True."""
    right_foot_flat: FootFlat = "auto"


def calibrate_subject(
    static: Recording | None,
    walk: Recording | None,
    given: Mapping[str, float],
    settings: CalibrationSettings | None = None,
) -> Calibration:
    """Calibration from all there is: a static, a walk's file, measurements given by the user.

    Raises:
        InvalidSubject: Measurements are missing or impossible.
    """
    measurements = body_measurements(given, static, walk)
    calibration = calibrate(static, measurements.values, settings)
    return replace(calibration, warnings=measurements.warnings + calibration.warnings)


def calibrate(
    static: Recording | None, parameters: Mapping[str, float], settings: CalibrationSettings | None = None
) -> Calibration:
    """Calibration from a static trial and body measurements.

    Args:
        static: Standing trial with the walk's marker placement; without one the offsets come from `parameters`.
        parameters: SI units: marker_diameter, inter_asis_distance, and with left_ and right_: leg_length, knee_width,
            ankle_width, asis_trochanter, optionally thigh_rotation, shank_rotation, tibial_torsion, ankle_abduction,
            static_plantar_flexion, static_rotation (signs as in Vicon's files).
        settings: Where the offsets come from, and how they are measured.

    Raises:
        InvalidSubject: A measurement is missing.
    """
    settings = settings or CalibrationSettings()
    _require(parameters)
    sides: dict[Side, SideCalibration] = {}
    warnings: list[str] = []
    for side in SIDES:
        sides[side], said = _calibrate_side(static, parameters, side, settings)
        warnings += said
    return Calibration(sides=sides, parameters=dict(parameters), warnings=tuple(warnings))


def _require(parameters: Mapping[str, float]) -> None:
    names = ["marker_diameter", "inter_asis_distance"] + [f"{side}_{name}" for side in SIDES for name in NEEDED]
    missing = [name for name in names if name not in parameters]
    if missing:
        raise InvalidSubject(
            f"body measurements are missing: {', '.join(missing)}; give them in metres, or a static to estimate them"
        )


def _calibrate_side(
    static: Recording | None, parameters: Mapping[str, float], side: Side, settings: CalibrationSettings
) -> tuple[SideCalibration, list[str]]:
    lengths = side_lengths(parameters, side)
    stored = stored_offsets(parameters, side)
    from_file = replace(lengths, **stored, offsets="file" if _has_static_offsets(stored) else "none")
    if static is None:
        nothing = [f"{side}: no static trial and no stored offsets; ankle and foot angles have an unknown offset"]
        return from_file, [] if from_file.offsets == "file" else nothing
    leg = StaticLeg(static=static, side=side, start=replace(lengths, **stored), method=settings.method)
    flat, warnings = _foot_flat(leg, settings, stored_offsets(static.parameters, side) or stored)
    computed = measure_offsets(leg, flat)
    warnings += _compare(side, computed, stored)
    if settings.offsets == "static":
        return computed, warnings
    if from_file.offsets == "file":
        return replace(from_file, method=computed.method, foot_flat=computed.foot_flat), warnings
    return computed, [*warnings, f"{side}: the file stores no static offsets; those computed from the static are used"]


def stored_offsets(parameters: Mapping[str, float], side: Side) -> dict[str, float]:
    """The offset angles [rad] of one side that the parameters hold, by their name without the side."""
    return {name: parameters[f"{side}_{name}"] for name in OFFSETS if f"{side}_{name}" in parameters}


def _has_static_offsets(stored: Mapping[str, float]) -> bool:
    """Whether a static was ever processed: then the foot's offsets are not exactly zero."""
    return any(stored.get(name, 0.0) != 0.0 for name in ("static_plantar_flexion", "static_rotation"))


def _foot_flat(leg: StaticLeg, settings: CalibrationSettings, stored: Mapping[str, float]) -> tuple[bool, list[str]]:
    chosen = settings.left_foot_flat if leg.side == "left" else settings.right_foot_flat
    if chosen != "auto":
        return chosen, []
    if _has_static_offsets(stored):
        misfit = {flat: _foot_misfit(measure_offsets(leg, flat), stored) for flat in (True, False)}
        flat = misfit[True] <= misfit[False]
        raised = f"{leg.side} foot taken as not flat in the static, because that fits the offsets stored in the file"
        return flat, [] if flat else [raised]
    flag = leg.static.parameters.get(f"{leg.side}_foot_flat")
    if flag is not None:
        return flag != 0.0, []
    return True, [f"{leg.side} foot assumed flat in the static; say so if the heel was raised"]


def _foot_misfit(computed: SideCalibration, stored: Mapping[str, float]) -> float:
    return abs(computed.static_plantar_flexion - stored.get("static_plantar_flexion", 0.0)) + abs(
        computed.static_rotation - stored.get("static_rotation", 0.0)
    )


def _compare(side: Side, computed: SideCalibration, stored: Mapping[str, float]) -> list[str]:
    """A warning when computed and stored offsets differ by more than one degree."""
    if not _has_static_offsets(stored):
        return []
    values = {name: (float(getattr(computed, name)), value) for name, value in stored.items()}
    different = [
        f"{name.replace('_', ' ')} {np.degrees(ours):.1f} against {np.degrees(theirs):.1f}"
        for name, (ours, theirs) in values.items()
        if abs(ours - theirs) > WORTH_A_WARNING
    ]
    if not different:
        return []
    return [
        f"{side}: offsets computed from the static differ from those stored in the file: {', '.join(different)} deg; "
        "the walk may have been processed with another static"
    ]
