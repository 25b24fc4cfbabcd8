"""Offsets of one leg measured in a static trial, as Plug-in Gait measures them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gaitlab.errors import InvalidRecording
from gaitlab.inverse.conventional import LegPose, abducted_ankle, leg_axes, leg_pose, pelvis_axes
from gaitlab.inverse.conventional_calibration import SIGN, CalibrationMethod, SideCalibration
from gaitlab.inverse.conventional_geometry import angle_about, chord, dot, frame_from_z, unit
from gaitlab.inverse.static_knee import device_apex, wears_device
from gaitlab.inverse.static_parameters import ANKLE_MEDIAL, KNEE_MEDIAL
from gaitlab.mocap.labels import require_markers
from gaitlab.mocap.recording import Recording, Side

OFFSETS = (
    "thigh_rotation",
    "shank_rotation",
    "tibial_torsion",
    "ankle_abduction",
    "static_plantar_flexion",
    "static_rotation",
)
"""Angles of a `SideCalibration` that a static trial, or the PROCESSING group of a file, may give."""


@dataclass(frozen=True, kw_only=True)
class StaticLeg:
    """What is needed to measure one leg."""

    static: Recording
    side: Side
    start: SideCalibration
    """Marker distances, and the angles that the method does not measure."""
    method: CalibrationMethod | Literal["auto"] = "auto"


def measure_offsets(leg: StaticLeg, foot_flat: bool) -> SideCalibration:
    """Calibration of one leg with the offsets of the static, means over its frames.

    With wands the rotations of thigh and shank are as given and only the foot is measured. With the knee alignment
    device or medial markers also the thigh's rotation and, when there is a medial ankle marker, the shank's rotation,
    tibial torsion and ankle abduction.

    Args:
        leg: The static and the leg's measurements.
        foot_flat: The sole is parallel to the floor: the heel marker is moved to the height of the toe marker.

    Raises:
        InvalidRecording: A marker is missing.
    """
    method = choose_method(leg)
    markers, letter = dict(leg.static.markers), leg.side[0].upper()
    if method == "knee alignment device":
        markers[f"{letter}KNE"] = device_apex(markers, leg.side)
    needed = [letter + name for name in ("THI", "KNE", "TIB", "ANK", "HEE", "TOE")]
    require_markers(leg.static.name, markers, ["LASI", "RASI", *needed])
    asis, pelvis = pelvis_axes(markers)
    hip = asis + pelvis @ leg.start.hip_centre
    if method == "wands":
        pose = leg_pose(markers, leg.side, leg.start, hip)
        measured = leg.start
        foot_y = pose.shank[:, :, 1]
    else:
        pose = _pose_from_axes(leg, method, markers, hip)
        measured = _leg_angles(leg, markers, hip, pose)
        foot_y = pose.shank_torsioned[:, :, 1]  # Vicon knows the torsion only after the static
    sole = leg.static.parameters.get(f"{leg.side}_sole_delta", 0.0) if foot_flat else None
    flexion, rotation = _foot_offsets(leg.side, (markers[f"{letter}TOE"], markers[f"{letter}HEE"]), pose, foot_y, sole)
    if not np.isfinite([flexion, rotation, measured.thigh_rotation, measured.shank_rotation]).all():
        raise InvalidRecording(
            f"{leg.static.name}: the {leg.side} leg's markers {', '.join(needed)} are never seen together; "
            "use a static in which they are, or the offsets stored in the file"
        )
    return replace(
        measured,
        static_plantar_flexion=flexion,
        static_rotation=rotation,
        method=method,
        foot_flat=foot_flat,
        offsets="static",
    )


def choose_method(leg: StaticLeg) -> CalibrationMethod:
    """The asked method; "auto": knee alignment device, else medial knee marker, else wands, by what is seen."""
    if leg.method != "auto":
        return leg.method
    if wears_device(leg.static.markers, leg.side):
        return "knee alignment device"
    return "wands" if _first_seen(leg.static.markers, leg.side, KNEE_MEDIAL) is None else "medial markers"


def _first_seen(markers: Mapping[str, np.ndarray], side: Side, names: tuple[str, ...]) -> np.ndarray | None:
    for name in names:
        marker = markers.get(side[0].upper() + name)
        if marker is not None and np.isfinite(marker).any():
            return marker
    return None


def _pose_from_axes(
    leg: StaticLeg, method: CalibrationMethod, markers: Mapping[str, np.ndarray], hip: np.ndarray
) -> LegPose:
    """Knee and ankle when the knee axis is known: it lies in the chord's plane; the ankle is between its markers."""
    letter, s = leg.side[0].upper(), SIGN[leg.side]
    knee_lateral, ankle_lateral = markers[f"{letter}KNE"], markers[f"{letter}ANK"]
    if method == "knee alignment device":
        pointer = markers[f"{letter}KAX"]
    else:
        require_markers(leg.static.name, markers, [f"{letter}{KNEE_MEDIAL[0]}"])
        pointer = 2 * knee_lateral - markers[f"{letter}{KNEE_MEDIAL[0]}"]
    knee = chord(hip, knee_lateral, pointer, leg.start.knee_distance, 0.0)
    knee_axis = s * (knee_lateral - knee)
    medial = _first_seen(markers, leg.side, ANKLE_MEDIAL)
    if medial is None:  # the ankle's axis is the knee's, turned by the given torsion
        pointer = knee + s * knee_axis
        ankle = chord(knee, ankle_lateral, pointer, leg.start.ankle_distance, s * leg.start.tibial_torsion)
        ankle = abducted_ankle(knee, ankle, ankle_lateral, leg.start.ankle_abduction)
    else:
        ankle = ankle_lateral + leg.start.ankle_distance * unit(medial - ankle_lateral)
    return leg_axes(hip, knee, ankle, (knee_axis, s * (ankle_lateral - ankle)), s * leg.start.tibial_torsion)


def _leg_angles(leg: StaticLeg, markers: Mapping[str, np.ndarray], hip: np.ndarray, pose: LegPose) -> SideCalibration:
    """Rotations of the wands, torsion and ankle abduction, with the signs of the PROCESSING group."""
    letter, s = leg.side[0].upper(), SIGN[leg.side]
    out_of_knee, out_of_ankle = markers[f"{letter}KNE"] - pose.knee, markers[f"{letter}ANK"] - pose.ankle
    bone = pose.knee - pose.ankle
    calibration = replace(
        leg.start,
        thigh_rotation=s * _mean(angle_about(hip - pose.knee, out_of_knee, markers[f"{letter}THI"] - pose.knee)),
        shank_rotation=s * _mean(angle_about(bone, out_of_ankle, markers[f"{letter}TIB"] - pose.ankle)),
    )
    if _first_seen(markers, leg.side, ANKLE_MEDIAL) is None:
        return calibration
    opening = np.arccos(dot(unit(out_of_ankle), unit(bone)))
    return replace(
        calibration,
        tibial_torsion=-s * _mean(angle_about(bone, pose.thigh[:, :, 1], pose.shank_torsioned[:, :, 1])),
        ankle_abduction=_mean(opening) - np.pi / 2,
    )


def _foot_offsets(
    side: Side, toe_heel: tuple[np.ndarray, np.ndarray], pose: LegPose, y_hint: np.ndarray, sole: float | None
) -> tuple[float, float]:
    """Plantar flexion and rotation [rad] from the frame of the line TOE - ankle to that of the sole TOE - HEE.

    Args:
        side: For the signs.
        toe_heel: Markers, laboratory frame [m], each (n, 3).
        pose: Of the leg.
        y_hint: Left axis of the shank, laboratory frame, shape (n, 3).
        sole: Height of the heel above the toes [m] when the foot is flat; None: as the markers lie.
    """
    toe, heel = toe_heel
    line = heel - toe
    if sole is not None:
        line = line * np.array([1.0, 1.0, 0.0]) + np.array([0.0, 0.0, sole])
    towards_ankle, along_sole = frame_from_z(pose.ankle - toe, y_hint), frame_from_z(line, y_hint)
    R = towards_ankle.transpose(0, 2, 1) @ along_sole  # = R_y(-flexion) R_x(-sign rotation) R_z
    return _mean(-np.arctan2(R[:, 0, 2], R[:, 2, 2])), -SIGN[side] * _mean(np.arcsin(np.clip(-R[:, 1, 2], -1.0, 1.0)))


def _mean(angle: np.ndarray) -> float:
    """Mean of an angle [rad] over the frames where it is known, shape (n,) or (n, 1)."""
    there = angle[np.isfinite(angle)]
    return float(np.arctan2(np.sin(there).sum(), np.cos(there).sum())) if there.size else np.nan
