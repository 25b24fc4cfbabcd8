"""A result folder of one trial whose tables and arrays are exact functions of time, for tests of the exports."""

import hashlib
from pathlib import Path

import numpy as np
from synthetic_output import document, write_output

from gaitlab.clinical.kinetics_document import UNITS
from gaitlab.pipelines.output import write_table

RATE, N, HEADING = 100.0, 60, 0.7  # [Hz], frames, [rad]
SEGMENTS = ("pelvis", "right_thigh", "right_shank", "right_foot", "left_thigh", "left_shank", "left_foot")
ANGLES = (
    *("pelvis_tilt", "pelvis_obliquity", "pelvis_rotation", "hip_flexion", "hip_adduction", "hip_rotation"),
    *("knee_flexion", "ankle_dorsiflexion", "foot_progression"),
)


def turn(heading=HEADING):
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def arrays():
    """walk.npz: the pelvis walks forward; one marker on it, one with a gap; one plate, loaded in the middle."""
    time = np.arange(N) / RATE
    q = np.zeros((N, 24))
    q[:, 0], q[:, 1], q[:, 2] = 1.2 * time - 0.3, 0.05, 0.9
    q[:, 3:] = 0.2 * np.sin(time[:, None] + np.arange(21.0))
    gait = np.stack([q[:, :3], q[:, :3] + [0.1, 0.2, -0.3]], axis=1)
    markers = gait @ turn().T
    markers[7, 1] = np.nan
    loaded = (time > 0.2) & (time < 0.4)
    force = np.where(loaded[:, None], np.array([50.0, -20.0, 600.0]), 0.0)[:, None]
    centre = np.where(loaded[:, None], np.array([0.2, 0.1, 0.0]), np.nan)[:, None]
    return {
        "time": time,
        "q_measured": q,
        "markers": markers,
        "marker_names": np.array(["LASI", "RASI"]),
        "segment_names": np.array([*SEGMENTS, "right_toe", "left_toe"]),
        "segment_positions_measured": np.repeat(q[:, None, :3], 9, axis=1) @ turn().T,
        "grf_plates": force @ turn().T,
        "cop_plates": centre @ turn().T,
        "free_moment_plates": np.where(loaded, -3.0, np.nan)[:, None],
    }


def tables(seed=0):
    """Columns of angles.csv and of kinetics.csv; moments and powers are known in frames 20 to 39 only."""
    rng = np.random.default_rng(seed)
    sides = ("left", "right")
    angles = {f"{side}_{name}": rng.normal(0.0, 30.0, N) for side in sides for name in ANGLES}
    known = np.where((np.arange(N) >= 20) & (np.arange(N) < 40), 1.0, np.nan)
    forces = {f"{side}_{name}": known * rng.normal(0.0, 1.0, N) for side in sides for name in UNITS}
    return angles, forces


def exported_trial(folder: Path, recording: bytes = b"recording", changed: dict | None = None) -> Path:
    """Writes the folder; `recording` are the contents of the file that it was made from."""
    written = document() | (changed or {})
    written["inputs"][1] |= {"sha256": hashlib.sha256(recording).hexdigest()}
    write_output(folder, written, arrays(), angles=False)
    angles, forces = tables()
    time = np.arange(N) / RATE
    write_table(folder / "angles.csv", time, angles, 5)
    write_table(folder / "kinetics.csv", time, forces, 5)
    return folder
