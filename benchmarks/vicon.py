"""Distance of the direct model to what Vicon stored in the same file, over the frames where Vicon's output is valid."""

from functools import cache
from pathlib import Path

import numpy as np
from registry import SHARED_DATA

from gaitlab.inverse.conventional import ConventionalKinematics
from gaitlab.mocap.c3d import read_c3d
from gaitlab.mocap.recording import Recording

CURVES = {
    "pelvis_tilt": ("PelvisAngles", 0),
    "pelvis_obliquity": ("PelvisAngles", 1),
    "pelvis_rotation": ("PelvisAngles", 2),
    "hip_flexion": ("HipAngles", 0),
    "hip_adduction": ("HipAngles", 1),
    "hip_rotation": ("HipAngles", 2),
    "knee_flexion": ("KneeAngles", 0),
    "ankle_dorsiflexion": ("AnkleAngles", 0),
    "foot_progression": ("FootProgressAngles", 2),
}
CENTRES = {"hip": "FEP", "knee": "FEO", "ankle": "TIO"}
SIDES = ("left", "right")
STEEP = 60.0  # [deg]; beyond it Vicon's foot progression may lie on another branch of its arc sine


@cache
def recording(pattern: str) -> Recording:
    """The first file in the folder of real recordings that matches `pattern`."""
    return read_c3d(next(iter(sorted(Path(SHARED_DATA).glob(pattern)))))


def worst_centre(walk: Recording, kinematics: ConventionalKinematics) -> float:
    """Largest rms distance of the six joint centres [mm]."""
    return max(
        rms(1e3 * np.linalg.norm(kinematics.joint_centres[f"{side}_{joint}"] - theirs, axis=1))
        for side in SIDES
        for joint, name in CENTRES.items()
        if (theirs := walk.model_outputs.get(side[0].upper() + name)) is not None
    )


def worst_curve(walk: Recording, kinematics: ConventionalKinematics) -> float:
    """Largest rms difference of the eighteen curves [deg]."""
    return max(
        rms(_difference(np.degrees(kinematics.angles[f"{side}_{curve}"]), theirs[:, axis], curve))
        for side in SIDES
        for curve, (name, axis) in CURVES.items()
        if (theirs := walk.model_outputs.get(side[0].upper() + name)) is not None
    )


def rms(values: np.ndarray) -> float:
    """Root mean square of the known values, any unit, shape (n,)."""
    return float(np.sqrt(np.nanmean(np.square(values))))


def _difference(ours: np.ndarray, theirs: np.ndarray, curve: str) -> np.ndarray:
    branches = [ours - theirs]
    if curve == "foot_progression" and np.nanmax(np.abs(theirs)) > STEEP:
        branches += [180.0 - ours - theirs, 180.0 + ours - theirs]
    wrapped = (np.array(branches) + 180.0) % 360.0 - 180.0
    return np.take_along_axis(wrapped, np.abs(wrapped).argmin(axis=0)[None], axis=0)[0]
