import numpy as np
import pytest
from exported_trial import RATE, N, exported_trial, tables
from synthetic_walk import Gait, synthetic_walk

from gaitlab.errors import OutputError
from gaitlab.mocap.c3d import extract, read_c3d, write_c3d
from gaitlab.report.export_c3d import export_c3d, point_outputs


@pytest.fixture
def recording(tmp_path):
    write_c3d(tmp_path / "walk.c3d", synthetic_walk(Gait(duration=N / RATE)))
    return tmp_path / "walk.c3d"


@pytest.fixture
def folder(tmp_path, recording):
    kinetics = {"moments_in": "the axes of the segment below the joint", "curves": {}, "contacts": [], "missing": []}
    changed = {"kinetics": kinetics | {"inertia": "the subject's model"}}
    return exported_trial(tmp_path / "result", recording.read_bytes(), changed)


def test_curves_come_back_from_the_file(recording, folder, tmp_path):
    export_c3d(folder, recording, tmp_path / "copy.c3d")
    outputs = read_c3d(tmp_path / "copy.c3d").model_outputs
    angles, forces = tables()
    found = {
        "left_hip_rotation": outputs["LHipAngles"][:, 2],
        "right_foot_progression": outputs["RFootProgressAngles"][:, 2],
        "right_knee_extensor_moment": outputs["RKneeMoment"][:, 0] / 1000.0,
        "left_ankle_evertor_moment": outputs["LAnkleMoment"][:, 1] / 1000.0,
        "left_ankle_power": outputs["LAnklePower"][:, 2],
    }
    for name, values in found.items():
        assert values == pytest.approx((angles | forces)[name], abs=1e-4, nan_ok=True), name


def test_points_say_what_they_mean(recording, folder, tmp_path):
    export_c3d(folder, recording, tmp_path / "copy.c3d")
    raw = extract(tmp_path / "copy.c3d")
    meaning = dict(zip(raw.texts("GAITLAB", "LABELS"), raw.texts("GAITLAB", "MEANING"), strict=True))
    assert len(meaning) == 22 and meaning["RKneeAngles"] == "knee flexion, not computed, not computed"
    assert meaning["LHipMoment"].endswith("internal, in the axes of the segment below the joint")


def test_without_plates_there_are_angles_alone(folder):
    (folder / "kinetics.csv").unlink()
    assert {point.kind for point in point_outputs(folder)} == {"ANGLES"}
    assert len(point_outputs(folder)) == 10


def test_another_recording_is_refused(folder, tmp_path):
    write_c3d(tmp_path / "other.c3d", synthetic_walk(Gait(duration=N / RATE, speed=0.9)))
    with pytest.raises(OutputError, match="other.c3d is not the file that this result was made from"):
        export_c3d(folder, tmp_path / "other.c3d", tmp_path / "copy.c3d")
    assert not (tmp_path / "copy.c3d").exists()


def test_a_recording_that_is_not_there_is_named(folder, tmp_path):
    with pytest.raises(OutputError, match="absent.c3d cannot be read"):
        export_c3d(folder, tmp_path / "absent.c3d", tmp_path / "copy.c3d")


def test_without_angles_nothing_is_exported(folder, recording, tmp_path):
    (folder / "angles.csv").unlink()
    with pytest.raises(OutputError, match=r"has no angles\.csv"):
        export_c3d(folder, recording, tmp_path / "copy.c3d")


def test_zero_components_are_zero_where_the_point_is_known(folder):
    knee = next(point for point in point_outputs(folder) if point.label == "LKneeAngles")
    assert not knee.values[:, 1:].any() and np.isfinite(knee.values).all()
