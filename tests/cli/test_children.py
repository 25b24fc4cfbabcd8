"""The command on every walk of the real recordings, against the file's own outputs: no setting per subject."""

import csv
import json

import numpy as np
import pytest

from gaitlab.cli.app import run
from gaitlab.mocap.c3d import read_c3d

pytestmark = [pytest.mark.shared_data, pytest.mark.slow]

CHILDREN = ("HC002D", "HC030A", "HC032A", "HC033A", "HC040A", "HC050A")
SESSIONS = [
    (f"children/{child}/static_*.c3d", f"children/{child}/{kind}_*.c3d")
    for child in CHILDREN
    for kind in ("straight", "turn")
]
SESSIONS += [("fmc_adult/*BP01.c3d", "fmc_adult/*BP06.c3d"), ("fmc_adult/*BP08.c3d", "fmc_adult/*BP15.c3d")]
SESSIONS += [("stairs_adult/Static*.c3d", "stairs_adult/Movement*.c3d"), (None, "ktk_walk/walk.c3d")]
KNEE, ANKLE = ("knee_flexion", "KneeAngles"), ("ankle_dorsiflexion", "AnkleAngles")
LIMIT_DEG = 0.2
LIMIT_MARKERS_M = 0.015
LIMIT_STAIRS_M = 0.02  # soft tissue of a heavy adult who steps down; the promise is for the children


def column(path, name):
    with path.open(newline="") as file:
        return np.array([float(row[name] or "nan") for row in csv.DictReader(file)])


@pytest.mark.parametrize(("static", "walk"), SESSIONS, ids=lambda pattern: str(pattern).rpartition("/")[2])
def test_main_job_without_weights(shared_data, tmp_path, static, walk):
    walk = next(shared_data.glob(walk))
    options = [] if static is None else ["--static", str(next(shared_data.glob(static)))]
    assert run(["analyse", *options, str(walk), "--out", str(tmp_path), "--no-weights"]) == 0
    theirs = read_c3d(walk).model_outputs
    for curve, output in (KNEE, ANKLE):
        for side in ("left", "right"):
            difference = column(tmp_path / "angles.csv", f"{side}_{curve}") - theirs[side[0].upper() + output][:, 0]
            assert np.sqrt(np.nanmean(difference**2)) < LIMIT_DEG, f"{side} {curve}"
    quality = json.loads((tmp_path / "result.json").read_text())["quality"]
    limit = LIMIT_STAIRS_M if walk.name == "Movement_trial.c3d" else LIMIT_MARKERS_M
    assert quality["marker_residual_rms_m"] < limit
