"""The direct conventional gait model: joint centres, segment axes and clinical angles, each frame by itself.

Newington (Davis) hip centre, chord construction of knee and ankle; conventions as measured on Plug-in Gait's files.
Sources: Davis et al. 1991, Hum Mov Sci 10:575; Kadaba et al. 1990, J Orthop Res 8:383.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gaitlab.inverse.clinical_angles import Forward, clinical_angles, forward_direction, travel_heading
from gaitlab.inverse.conventional_calibration import SIDES, SIGN, Calibration, SideCalibration
from gaitlab.inverse.conventional_geometry import (
    chord,
    frame_from_y,
    frame_from_z,
    norm,
    rotation_x,
    rotation_y,
    rotation_z,
    unit,
)
from gaitlab.inverse.static_knee import knee_marker
from gaitlab.mocap.labels import require_markers
from gaitlab.mocap.recording import Recording, Side

REQUIRED = ("LASI", "RASI") + tuple(side + name for name in ("THI", "KNE", "TIB", "ANK", "TOE") for side in "LR")
"""Markers without which a walk has no joint angles, besides SACR or LPSI with RPSI."""


@dataclass(frozen=True, kw_only=True)
class KinematicsSettings:
    """Choices of the direct model."""

    forward: Forward = "laboratory axis"
    """What pelvis rotation and foot progression are measured against: the laboratory axis next to the direction of
    travel, as Plug-in Gait does, or the direction of travel itself."""
    foot: Literal["calibrated", "sole"] = "calibrated"
    """Calibrated: the line from toe to ankle turned by the static offsets, for walks. Sole: the line from toe to heel
    marker itself, as Plug-in Gait does in the static that it measures the offsets in."""


@dataclass(frozen=True, kw_only=True)
class SegmentFrames:
    """Pose of one segment over a trial."""

    origin: np.ndarray
    """Proximal joint centre, of the pelvis the mid-point of the hips, laboratory frame [m], shape (n, 3)."""
    rotation: np.ndarray
    """Columns are the segment's axes forward, left, up (foot: toes, left, up), laboratory frame, shape (n, 3, 3)."""


@dataclass(frozen=True, kw_only=True)
class ConventionalKinematics:
    """Result of the direct model; NaN in frames where a marker is missing."""

    segments: Mapping[str, SegmentFrames]
    """pelvis, and with left_ or right_: thigh, shank (y along the knee axis), shank_torsioned (y along the ankle axis),
    foot."""
    joint_centres: Mapping[str, np.ndarray]
    """left_hip, left_knee, left_ankle, right_hip ..., laboratory frame [m], shape (n, 3)."""
    angles: Mapping[str, np.ndarray]
    """left_pelvis_tilt, left_hip_flexion ..., clinical signs [rad], shape (n,); see `clinical_angles`."""
    heading: float
    """Direction of travel about the vertical [rad], 0 along the laboratory's x axis."""
    forward: float
    """Direction that pelvis rotation and foot progression are measured against [rad]."""


@dataclass(frozen=True, kw_only=True)
class LegPose:
    """Joint centres and axes of one leg."""

    knee: np.ndarray
    """Laboratory frame [m], shape (n, 3)."""
    ankle: np.ndarray
    """Laboratory frame [m], shape (n, 3)."""
    thigh: np.ndarray
    """Axes, laboratory frame, shape (n, 3, 3)."""
    shank: np.ndarray
    """Axes with y along the knee axis, laboratory frame, shape (n, 3, 3)."""
    shank_torsioned: np.ndarray
    """Axes with y along the ankle axis, laboratory frame, shape (n, 3, 3)."""


def joint_kinematics(
    recording: Recording, calibration: Calibration, settings: KinematicsSettings | None = None
) -> ConventionalKinematics:
    """Joint centres, segment axes and clinical angles of every frame.

    Args:
        recording: Walk or static; markers in the laboratory frame [m], shape (n, 3), gaps filled as far as wished.
        calibration: Of the same person and marker placement.
        settings: What is called forward.

    Raises:
        InvalidRecording: A marker of the model is missing in the whole trial.
    """
    settings = settings or KinematicsSettings()
    markers = dict(recording.markers)
    for side in SIDES:
        markers |= knee_marker(markers, side)
    require_markers(recording.name, markers, REQUIRED)
    asis, pelvis = pelvis_axes(markers)
    centres: dict[str, np.ndarray] = {}
    segments: dict[str, SegmentFrames] = {}
    for side in SIDES:
        calibrated = calibration.sides[side]
        hip = asis + pelvis @ calibrated.hip_centre
        leg = leg_pose(markers, side, calibrated, hip)
        if settings.foot == "sole":
            require_markers(recording.name, markers, [f"{side[0].upper()}HEE"])
            delta = recording.parameters.get(f"{side}_sole_delta", 0.0)
            foot = sole_axes(markers, side, calibrated, leg, delta)
        else:
            foot = foot_axes(markers, side, calibrated, leg)
        centres |= {f"{side}_hip": hip, f"{side}_knee": leg.knee, f"{side}_ankle": leg.ankle}
        segments |= {
            f"{side}_thigh": SegmentFrames(origin=hip, rotation=leg.thigh),
            f"{side}_shank": SegmentFrames(origin=leg.knee, rotation=leg.shank),
            f"{side}_shank_torsioned": SegmentFrames(origin=leg.knee, rotation=leg.shank_torsioned),
            f"{side}_foot": SegmentFrames(origin=leg.ankle, rotation=foot),
        }
    middle = (centres["left_hip"] + centres["right_hip"]) / 2
    segments = {"pelvis": SegmentFrames(origin=middle, rotation=pelvis), **segments}
    heading = travel_heading(middle, pelvis[:, :, 0])
    forward = forward_direction(heading, settings.forward)
    rotations = {name: segment.rotation for name, segment in segments.items()}
    return ConventionalKinematics(
        segments=segments,
        joint_centres=centres,
        angles=clinical_angles(rotations, forward),
        heading=heading,
        forward=forward,
    )


def pelvis_axes(markers: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Mid-point of the ASIS markers (n, 3) [m] and axes forward, left, up (n, 3, 3), laboratory frame.

    y points from RASI to LASI, x lies in the plane of the ASIS markers and the sacrum (SACR, else the mid-point of the
    PSIS markers).
    """
    left, right = markers["LASI"], markers["RASI"]
    middle = (left + right) / 2
    sacrum = markers["SACR"] if _seen(markers, "SACR") else (markers["LPSI"] + markers["RPSI"]) / 2
    return middle, frame_from_y(left - right, middle - sacrum)


def _seen(markers: Mapping[str, np.ndarray], name: str) -> bool:
    return name in markers and bool(np.isfinite(markers[name]).any())


def leg_pose(markers: Mapping[str, np.ndarray], side: Side, calibration: SideCalibration, hip: np.ndarray) -> LegPose:
    """Knee, ankle and the axes of thigh and shank from a hip centre (n, 3), laboratory frame [m].

    Knee and ankle are chords from the thigh and shank wands; then the ankle abduction turns the ankle centre.
    """
    letter, s = side[0].upper(), SIGN[side]
    knee_lateral, ankle_lateral = markers[f"{letter}KNE"], markers[f"{letter}ANK"]
    knee = chord(hip, knee_lateral, markers[f"{letter}THI"], calibration.knee_distance, s * calibration.thigh_rotation)
    ankle = chord(
        knee, ankle_lateral, markers[f"{letter}TIB"], calibration.ankle_distance, s * calibration.shank_rotation
    )
    ankle = abducted_ankle(knee, ankle, ankle_lateral, calibration.ankle_abduction)
    return leg_axes(
        hip, knee, ankle, (s * (knee_lateral - knee), s * (ankle_lateral - ankle)), s * calibration.tibial_torsion
    )


def abducted_ankle(knee: np.ndarray, ankle: np.ndarray, lateral: np.ndarray, abduction: float) -> np.ndarray:
    """Ankle centre C turned upwards about the marker ANK by `abduction` [rad], laboratory frame [m], shape (n, 3).

    With v = C - ANK and k the bone axis, which is across v: C' = ANK + v cos + |v| k sin.
    """
    inwards = ankle - lateral
    return lateral + inwards * np.cos(abduction) + norm(inwards) * unit(knee - ankle) * np.sin(abduction)


def leg_axes(
    hip: np.ndarray, knee: np.ndarray, ankle: np.ndarray, axes: tuple[np.ndarray, np.ndarray], torsion: float
) -> LegPose:
    """Axes of thigh and shank from joint centres (n, 3) [m] and the knee's and ankle's axes (n, 3), pointing left.

    z runs up the bone, y along the joint's axis. The shank has a second frame, turned about z by `torsion` [rad].
    """
    shank_torsioned = frame_from_z(knee - ankle, axes[1])
    return LegPose(
        knee=knee,
        ankle=ankle,
        thigh=frame_from_z(hip - knee, axes[0]),
        shank=shank_torsioned @ rotation_z(torsion),
        shank_torsioned=shank_torsioned,
    )


def foot_axes(markers: Mapping[str, np.ndarray], side: Side, calibration: SideCalibration, leg: LegPose) -> np.ndarray:
    """Axes toes, left, up of the foot, laboratory frame, shape (n, 3, 3).

    The line from TOE to the ankle centre with y of the untorsioned shank, turned by the static offsets.
    """
    line = leg.ankle - markers[f"{side[0].upper()}TOE"]  # (n, 3)
    offset = rotation_y(-calibration.static_plantar_flexion) @ rotation_x(-SIGN[side] * calibration.static_rotation)
    return frame_from_z(line, leg.shank[:, :, 1]) @ (offset @ rotation_y(np.pi / 2))


def sole_axes(
    markers: Mapping[str, np.ndarray], side: Side, calibration: SideCalibration, leg: LegPose, delta: float
) -> np.ndarray:
    """Axes toes, left, up of a foot in the static, laboratory frame, shape (n, 3, 3).

    The line from TOE to HEE, levelled to the height `delta` [m] of the heel above the toes where the sole lies flat,
    with y of the shank as it was known when the offsets were measured: untorsioned with wands, else torsioned.
    """
    letter = side[0].upper()
    line = markers[f"{letter}HEE"] - markers[f"{letter}TOE"]  # (n, 3)
    if calibration.foot_flat is not False:
        line = line * np.array([1.0, 1.0, 0.0]) + np.array([0.0, 0.0, delta])
    shank = leg.shank if calibration.method == "wands" else leg.shank_torsioned
    return frame_from_z(line, shank[:, :, 1]) @ rotation_y(np.pi / 2)
