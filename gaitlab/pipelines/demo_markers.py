"""Markers on the demo children, placed so that the conventional gait model finds the joint centres they really have.

Pelvis markers follow from the hip centres by the Newington regression, knee and ankle markers lie on the joints' axes
at half of joint width and marker diameter, and wands lie in the plane of bone and axis, so that wand angles are zero.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from ..inverse.conventional_calibration import newington_hip_centre
from ..inverse.conventional_geometry import rotation_y
from ..multibody.kinematics import point_positions, rotation_matrices
from ..multibody.subject import PointOnSegment, SubjectModel
from .demo_gait import FIRST_JOINT, flat_ankle
from .demo_patterns import SIDES, SIGN, GaitPattern

MARKER_DIAMETER = 0.014  # [m]
KNEE_WIDTH, ANKLE_WIDTH = 0.11, 0.075  # of the length of thigh and shank together
SACRUM_BEHIND_ASIS = 0.17  # [m]
PSIS_HALF_DISTANCE = 0.04  # [m]
FOOT_MARKER_ABOVE_SOLE = 0.03  # [m]
WANDS = {"THI": (0.09, -0.55), "TIB": (0.08, -0.5)}
"""Lateral distance of a wand's marker from the bone [m], and its place along the bone, share of the length."""
TRUNK = {"C7": (-0.065, 0.36), "T10": (-0.10, 0.12), "CLAV": (0.065, 0.30), "STRN": (0.095, 0.14)}
"""Forward of the trunk's axis [m], and up from its lower end [m]."""


def body_parameters(subject: SubjectModel, height: float) -> dict[str, float]:
    """Measurements of a subject as a laboratory would note them, SI units; height of the body [m]."""
    bones = {side: _bone(subject, side, 1) + _bone(subject, side, 2) for side in SIDES}
    mean = sum(bones.values()) / 2
    half_width = abs(subject.segments[1].joint_offset[1])
    legs = {side: round(bone + 0.04, 3) for side, bone in bones.items()}
    inner = newington_hip_centre(sum(legs.values()) / 2, 0.0, 0.0, 0.0)[1]
    values = {
        "mass": round(subject.mass, 1),
        "height": height,
        "marker_diameter": MARKER_DIAMETER,
        "inter_asis_distance": round(2 * (half_width - inner), 3),
    }
    for side in SIDES:
        values |= {
            f"{side}_leg_length": legs[side],
            f"{side}_knee_width": round(KNEE_WIDTH * mean, 3),
            f"{side}_ankle_width": round(ANKLE_WIDTH * mean, 3),
            f"{side}_asis_trochanter": round(0.1288 * sum(legs.values()) / 2 - 0.04856, 4),
        }
        values |= {f"{side}_{angle}": 0.0 for angle in ("thigh_rotation", "shank_rotation", "tibial_torsion")}
        values[f"{side}_foot_flat"] = 1.0
    return values


def _bone(subject: SubjectModel, side: str, part: int) -> float:
    """Length of thigh (1) or shank (2) [m]."""
    return -float(subject.segments[part + (1 if side == "right" else 4)].joint_offset[2])


def with_markers(subject: SubjectModel, parameters: Mapping[str, float], tilt: float) -> SubjectModel:
    """The subject with the markers of Plug-in Gait's lower body and trunk.

    Args:
        subject: Of the presets.
        parameters: Of `body_parameters`.
        tilt: Of the markers' pelvis against the model's [rad].
    """
    markers = _pelvis_markers(parameters, tilt, abs(subject.segments[1].joint_offset[1])) | _trunk_markers(subject)
    for side in SIDES:
        markers |= _leg_markers(subject, parameters, side)
    return replace(subject, markers=markers)


def _pelvis_markers(parameters: Mapping[str, float], tilt: float, half_width: float) -> dict[str, PointOnSegment]:
    leg = (parameters["left_leg_length"] + parameters["right_leg_length"]) / 2
    inter_asis, trochanter = parameters["inter_asis_distance"], parameters["left_asis_trochanter"]
    hip = newington_hip_centre(leg, trochanter, inter_asis, parameters["marker_diameter"] / 2)
    # The rounded distance must give the hips their exact width.
    half = inter_asis / 2 + half_width - hip[1]
    axes = rotation_y(tilt)
    middle = -axes @ (hip * [1.0, 0.0, 1.0])
    places = {"ASI": np.array([0.0, half, 0.0]), "PSI": np.array([-SACRUM_BEHIND_ASIS, PSIS_HALF_DISTANCE, 0.0])}
    return {
        side[0].upper() + name: PointOnSegment(segment=0, position=middle + axes @ (place * [1.0, SIGN[side], 1.0]))
        for side in SIDES
        for name, place in places.items()
    }


def _trunk_markers(subject: SubjectModel) -> dict[str, PointOnSegment]:
    """On the trunk that the preset welds to the pelvis: its lower end is 0.135 m above the hips."""
    del subject
    return {
        name: PointOnSegment(segment=0, position=np.array([forward + 0.1 * up, 0.0, 0.135 + up]))
        for name, (forward, up) in TRUNK.items()
    }


def _leg_markers(subject: SubjectModel, parameters: Mapping[str, float], side: str) -> dict[str, PointOnSegment]:
    letter, first, s = side[0].upper(), (1 if side == "right" else 4), SIGN["right" if side == "right" else "left"]
    diameter = parameters["marker_diameter"]
    knee = (parameters[f"{side}_knee_width"] + diameter) / 2
    ankle = (parameters[f"{side}_ankle_width"] + diameter) / 2
    thigh, shank = _bone(subject, side, 1), _bone(subject, side, 2)
    places = {
        "THI": (first, np.array([0.0, s * WANDS["THI"][0], WANDS["THI"][1] * thigh])),
        "KNE": (first, np.array([0.0, s * knee, -thigh])),
        "TIB": (first + 1, np.array([0.0, s * WANDS["TIB"][0], WANDS["TIB"][1] * shank])),
        "ANK": (first + 1, np.array([0.0, s * ankle, -shank])),
    }
    heel, toe = (subject.contacts[f"{side}_{part}"].position for part in ("heel", "toe"))
    along = (toe - heel) / np.linalg.norm(toe - heel)
    above = np.array([-along[2], 0.0, along[0]])  # the feet's sole holds y
    above *= np.sign(above[0])
    places |= {
        "HEE": (first + 2, heel + FOOT_MARKER_ABOVE_SOLE * above),
        "TOE": (first + 2, toe + FOOT_MARKER_ABOVE_SOLE * above),
    }
    return {letter + name: PointOnSegment(segment=k, position=place) for name, (k, place) in places.items()}


def standing_coordinates(subject: SubjectModel, pattern: GaitPattern) -> np.ndarray:
    """Coordinates of the static trial: the pattern's standing posture, both soles on the floor [m, rad], shape (n_q,).

    Soles are level in both directions, so that a foot in the static has no roll.
    """
    wanted = np.zeros(subject.n_q)
    angle = {name: np.radians(value) for name, value in pattern.standing.items()}
    wanted[2] = sum(_bone(subject, "right", part) for part in (1, 2)) + 0.05
    wanted[3] = angle["pelvis_tilt"] - pattern.tilt
    for side in SIDES:
        first = FIRST_JOINT[side]
        wanted[first] = pattern.tilt - angle["hip_flexion"]
        wanted[first + 2] = -SIGN[side] * angle.get("hip_rotation", 0.0)
        wanted[first + 3] = angle["knee_flexion"]
        lean = angle["pelvis_tilt"] - angle["hip_flexion"] + angle["knee_flexion"]
        wanted[first + 6] = flat_ankle(subject, side) - lean

    def residuals(q: np.ndarray) -> np.ndarray:
        soles = point_positions(subject, subject.contacts, q[None])
        heights = np.array([soles[name][0, 2] for name in soles])
        return np.concatenate([heights / 1e-6, _rolls(subject, q) / 1e-5, (q - wanted) / 0.1])

    return np.asarray(least_squares(residuals, wanted, xtol=1e-15, ftol=1e-15, gtol=1e-15).x)


def _rolls(subject: SubjectModel, q: np.ndarray) -> np.ndarray:
    """Inclination of the feet's y axes [rad], shape (2,)."""
    rolls: list[float] = []
    for side in SIDES:
        axes = rotation_matrices(q[3:6])
        for segment, first in ((1, 0), (2, 3), (3, 6)):
            offset = subject.segments[segment + (0 if side == "right" else 3)].rotation_offset
            joint = FIRST_JOINT[side] + first
            axes = axes @ rotation_matrices(q[joint : joint + 3] + offset)
        rolls.append(float(axes[2, 1]))
    return np.array(rolls)
