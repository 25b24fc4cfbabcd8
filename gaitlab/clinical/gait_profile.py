"""Gait variable scores, movement analysis profile and gait profile score (Baker et al., Gait Posture 30:265, 2009)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

PELVIS = ("pelvis_tilt", "pelvis_obliquity", "pelvis_rotation")
VARIABLES = (
    *PELVIS,
    "hip_flexion",
    "hip_adduction",
    "hip_rotation",
    "knee_flexion",
    "ankle_dorsiflexion",
    "foot_progression",
)
"""The nine kinematic variables of one side."""
GPS_MINIMAL_DIFFERENCE = 1.6
"""Minimal clinically important difference of the gait profile score [deg] (Baker et al., Gait Posture 35:612, 2012)."""


@dataclass(frozen=True, kw_only=True)
class GaitProfile:
    """Movement analysis profile of one side."""

    gvs: Mapping[str, float]
    """Gait variable scores [deg], those that could be computed."""
    gps: float | None
    """Root mean square of all nine [deg]; None when one is missing."""
    missing: tuple[str, ...]
    """Variables without a curve or without a reference."""


def gait_variable_score(curve: np.ndarray, reference: np.ndarray) -> float:
    """Root mean square difference of a curve from the reference mean over the cycle [deg], both of shape (101,)."""
    return float(np.sqrt(np.mean(np.square(curve - reference))))


def gait_profile(curves: Mapping[str, np.ndarray], reference: Mapping[str, np.ndarray]) -> GaitProfile:
    """Profile of one side.

    Args:
        curves: Curves of the person by name [deg], shape (101,) each; one with NaN counts as missing.
        reference: Means of the reference cohort [deg], shape (101,) each.
    """
    usable = [
        name
        for name in VARIABLES
        if name in curves and name in reference and np.all(np.isfinite(curves[name])) and np.size(curves[name])
    ]
    gvs = {name: gait_variable_score(curves[name], reference[name]) for name in usable}
    missing = tuple(name for name in VARIABLES if name not in gvs)
    return GaitProfile(gvs=gvs, gps=None if missing else _rms(list(gvs.values())), missing=missing)


def overall_score(left: GaitProfile, right: GaitProfile) -> float | None:
    """Gait profile score of the person [deg]: both sides, the pelvis once, from the left; None when one is missing."""
    if left.gps is None or right.gps is None:
        return None
    return _rms([*left.gvs.values(), *(score for name, score in right.gvs.items() if name not in PELVIS)])


def _rms(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
