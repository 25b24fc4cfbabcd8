"""The gait frame: x forward, y left, z up; the laboratory frame turned about z by minus the heading."""

import numpy as np


def rotation_gait_to_lab(heading: float) -> np.ndarray:
    """R_z(heading [rad]), shape (3, 3)."""
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def lab_to_gait(points: np.ndarray, heading: float) -> np.ndarray:
    """Points or vectors, shape (..., 3), any unit, from the laboratory to the gait frame of this heading [rad]."""
    return points @ rotation_gait_to_lab(heading)


def gait_to_lab(points: np.ndarray, heading: float) -> np.ndarray:
    """Points or vectors, shape (..., 3), any unit, from the gait frame of this heading [rad] to the laboratory."""
    return points @ rotation_gait_to_lab(heading).T
