"""What the conventional gait model must know about a person before it can read a walk."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from gaitlab.mocap.recording import Side

SIDES: tuple[Side, Side] = ("left", "right")
SIGN: Mapping[Side, float] = {"left": 1.0, "right": -1.0}
"""+1 where the body's left-pointing y axis is lateral. Angles of calibration are stored mirrored, as Vicon does."""

CalibrationMethod = Literal["wands", "knee alignment device", "medial markers"]


@dataclass(frozen=True, kw_only=True)
class SideCalibration:
    """Constants of one leg. All angles [rad] have the signs of the PROCESSING group of Vicon's files."""

    hip_centre: np.ndarray
    """In the pelvis axes (x forward, y left, z up) from the mid-point of the ASIS markers [m], shape (3,)."""
    knee_distance: float
    """Knee centre to KNE marker [m]: half of knee width and marker diameter."""
    ankle_distance: float
    """Ankle centre to ANK marker [m]: half of ankle width and marker diameter."""
    thigh_rotation: float = 0.0
    """From the knee axis to the THI marker about the bone axis."""
    shank_rotation: float = 0.0
    """From the ankle axis to the TIB marker about the bone axis."""
    tibial_torsion: float = 0.0
    """From the ankle axis to the knee axis about the bone axis, negative when the foot turns out."""
    ankle_abduction: float = 0.0
    """Turns the ankle centre about ANK, upwards when positive; Vicon's AnkleAbAdd."""
    static_plantar_flexion: float = 0.0
    """Vicon's StaticPlantFlex: line TOE -> ankle centre to sole."""
    static_rotation: float = 0.0
    """Vicon's StaticRotOff."""
    method: CalibrationMethod = "wands"
    """How the knee axis was found."""
    foot_flat: bool | None = None
    """Whether the sole was taken to lie flat in the static; None when there is no static."""
    offsets: Literal["file", "static", "none"] = "none"
    """Where the angles come from."""


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """Constants of the conventional gait model for one person and session."""

    sides: Mapping[Side, SideCalibration]
    parameters: Mapping[str, float] = field(default_factory=dict[str, float])
    """The body measurements that were used, SI units."""
    warnings: tuple[str, ...] = ()


def newington_hip_centre(leg_length: float, asis_trochanter: float, inter_asis: float, radius: float) -> np.ndarray:
    """Left hip centre in the pelvis axes (x forward, y left, z up) from the ASIS mid-point [m], shape (3,).

    With C = 0.115 leg - 0.0153, theta = 0.5 and beta = 0.314 rad:
        x = C cos(theta) sin(beta) - (t + radius) cos(beta)
        y = inter_asis / 2 - C sin(theta)
        z = -C cos(theta) cos(beta) - (t + radius) sin(beta)
    where t is the distance from ASIS to trochanter along x and radius that of the markers. Mirror y for the right.

    Source: Davis et al. 1991, Hum Mov Sci 10:575 (Newington hip regression); leg is the mean of both legs.
    """
    theta, beta = 0.5, 0.314
    C = 0.115 * leg_length - 0.0153
    depth = asis_trochanter + radius
    return np.array(
        [
            C * np.cos(theta) * np.sin(beta) - depth * np.cos(beta),
            inter_asis / 2 - C * np.sin(theta),
            -C * np.cos(theta) * np.cos(beta) - depth * np.sin(beta),
        ]
    )


def side_lengths(parameters: Mapping[str, float], side: Side) -> SideCalibration:
    """The calibration of one leg without any angle: hip centre (pelvis axes) and marker distances [m]."""
    diameter = parameters["marker_diameter"]
    leg = (parameters["left_leg_length"] + parameters["right_leg_length"]) / 2
    hip = newington_hip_centre(
        leg, parameters[f"{side}_asis_trochanter"], parameters["inter_asis_distance"], diameter / 2
    )
    hip[1] *= SIGN[side]
    return SideCalibration(
        hip_centre=hip,
        knee_distance=(parameters[f"{side}_knee_width"] + diameter) / 2,
        ankle_distance=(parameters[f"{side}_ankle_width"] + diameter) / 2,
    )
