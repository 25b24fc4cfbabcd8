"""Real trials, read once, and what Vicon made of them."""

from functools import cache

import numpy as np
import pytest

from gaitlab.mocap.c3d import extract
from gaitlab.mocap.interpretation import interpret

VICON_CURVES = {
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
VICON_CENTRES = {"hip": "FEP", "knee": "FEO", "ankle": "TIO"}


@cache
def read(path):
    return interpret(extract(path), path.stem, "")


@pytest.fixture(scope="session")
def trial(shared_data):
    """Recording of a file in the folder of real recordings; the name may hold wild cards."""
    return lambda pattern: read(next(shared_data.glob(pattern + ".c3d")))


@pytest.fixture(scope="session")
def vicon():
    """Vicon's own curves [deg] and joint centres [m] of a recording."""
    return vicon_results


def vicon_results(recording):
    sides = [(side, side[0].upper()) for side in ("left", "right")]
    outputs = recording.model_outputs
    curves = {f"{s}_{c}": outputs[L + name][:, k] for s, L in sides for c, (name, k) in VICON_CURVES.items()}
    centres = {f"{s}_{j}": outputs[L + name] for s, L in sides for j, name in VICON_CENTRES.items()}
    for name, values in (curves | centres).items():
        assert np.isfinite(values).any(), name
    return curves, centres
