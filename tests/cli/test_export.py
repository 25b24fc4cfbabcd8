"""`gaitlab export` on a real recording, and what it says when it cannot."""

import json
import shutil

import numpy as np
import pytest

from gaitlab.cli.app import run
from gaitlab.mocap.c3d import extract, read_c3d
from gaitlab.report.walk_file import read_frames

pytestmark = pytest.mark.shared_data


@pytest.fixture(scope="module")
def result(files, tmp_path_factory):
    """Result folder of the child's walk."""
    out = tmp_path_factory.mktemp("analysed") / "out"
    arguments = ["analyse", "--static", files / "static.c3d", files / "straight.c3d", "--out", out, "--no-weights"]
    assert run([str(argument) for argument in arguments]) == 0
    return out


def test_every_format(gaitlab, files, result, tmp_path):
    formats = [word for name in ("c3d", "trc", "mot", "fhir", "csv", "json") for word in ("--to", name)]
    code, out, err = gaitlab("export", result, *formats, "--out", tmp_path, "--recording", files / "straight.c3d")
    assert (code, err) == (0, "")
    written = sorted(path.name.removeprefix("straight") for path in tmp_path.iterdir())
    plain = [".json", ".trc", "_coordinates.mot", "_curves.csv", "_events.csv", "_fhir.json"]
    assert written == [*plain, "_gaitlab.c3d", "_plates.mot", "_values.csv"]
    assert all(name in out.replace("\n", "") for name in written)


def test_a_c3d_holds_what_the_file_had_and_what_was_computed(gaitlab, files, result, tmp_path):
    recording = files / "straight.c3d"
    assert gaitlab("export", result, "--to", "c3d", "--out", tmp_path, "--recording", recording)[0] == 0
    before, after = extract(recording), extract(tmp_path / "straight_gaitlab.c3d")
    n = before.points.shape[1]
    assert np.array_equal(before.points, after.points[:, :n], equal_nan=True)
    assert np.array_equal(before.analog, after.analog) and before.labels == after.labels[:n]
    outputs = read_c3d(tmp_path / "straight_gaitlab.c3d").model_outputs
    angles, forces = (read_frames(result / name) for name in ("angles.csv", "kinetics.csv"))
    # The file has Plug-in Gait's own points, so ours bear another name.
    assert outputs["LKneeAngles_gaitlab"][:, 0] == pytest.approx(angles["left_knee_flexion"], abs=1e-4)
    moment = outputs["RHipMoment_gaitlab"][:, 1] / 1000.0
    assert moment == pytest.approx(forces["right_hip_abductor_moment"], abs=1e-4, nan_ok=True)
    stored = outputs["RHipMoment"][:, 1] / 1000.0  # Vicon's, other inertia: the same sign and size
    known = np.isfinite(moment) & (np.abs(stored) > 0.1)
    assert known.any() and np.sqrt(np.mean(np.square(moment[known] - stored[known]))) < 0.08


def test_several_trials_find_their_recordings(gaitlab, files, tmp_path):
    shutil.copy(files / "straight.c3d", tmp_path / "again.c3d")
    walks = (files / "straight.c3d", tmp_path / "again.c3d")
    out = tmp_path / "out"
    assert gaitlab("analyse", "--static", files / "static.c3d", *walks, "--out", out, "--no-weights")[0] == 0
    code, said, _ = gaitlab("export", out, "--to", "c3d", "--to", "trc", "--to", "csv", "--recording", walks[1])
    assert code == 0
    names = {path.name for path in (out / "export").iterdir()}
    assert {"again.trc", "straight.trc", "again_gaitlab.c3d", "out_curves.csv"} <= names
    assert "straight_gaitlab.c3d" not in names


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--to", "c3d"), "give the C3D file with --recording"),
        (("--to", "xls"), "export format 'xls' does not exist; available: c3d, csv, fhir, json, mot, trc"),
        ((), "Missing option '--to'"),
    ],
)
def test_what_cannot_be_exported_is_said(gaitlab, result, options, words):
    code, _, err = gaitlab("export", result, *options)
    assert code == 2 and words in err


def test_another_recording_is_refused(gaitlab, files, result):
    code, _, err = gaitlab("export", result, "--to", "c3d", "--recording", files / "static.c3d")
    assert code == 2 and "static.c3d is no file that this result was made from (straight, by sha256)" in err


def test_a_folder_without_a_result_is_left_alone(gaitlab, tmp_path):
    code, _, err = gaitlab("export", tmp_path, "--to", "csv")
    assert code == 2 and "has no result.json" in err and list(tmp_path.iterdir()) == []


def test_a_walk_without_plates_says_that_there_are_no_reactions(gaitlab, result, tmp_path):
    shutil.copytree(result, tmp_path / "copy")
    with np.load(tmp_path / "copy" / "walk.npz") as archive:
        arrays = dict(archive)
    arrays |= {"grf_plates": arrays["grf_plates"][:, :0], "cop_plates": arrays["cop_plates"][:, :0]}
    np.savez(tmp_path / "copy" / "walk.npz", **arrays)
    code, out, _ = gaitlab("export", tmp_path / "copy", "--to", "mot", "--out", tmp_path)
    assert code == 0 and "no ground reactions, the file holds no usable force plate" in out
    assert not (tmp_path / "straight_plates.mot").exists()


def test_the_json_is_the_result(gaitlab, result, tmp_path):
    assert gaitlab("export", result, "--to", "json", "--out", tmp_path)[0] == 0
    assert json.loads((tmp_path / "straight.json").read_text()) == json.loads((result / "result.json").read_text())
