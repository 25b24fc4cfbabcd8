"""The command on a real recording, without weights, against the file's own outputs."""

import csv
import json

import numpy as np
import pytest

from gaitlab.cli.app import run
from gaitlab.clinical.document import CURVES, SIDES

pytestmark = pytest.mark.shared_data

FILES = {"result.json", "angles.csv", "joint_centres.csv", "kinetics.csv", "model.urdf", "walk.npz", "report.html"}


@pytest.fixture(scope="module")
def out(files, tmp_path_factory):
    folder = tmp_path_factory.mktemp("out")
    assert run_on(files, folder, "straight.c3d") == 0
    return folder


def run_on(files, folder, *walks):
    arguments = ["--static", files / "static.c3d", *(files / walk for walk in walks), "--out", folder, "--no-weights"]
    return run(["analyse", *map(str, arguments)])


def table(path):
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}


def test_everything_is_there(out):
    assert {path.name for path in out.iterdir()} == FILES


def test_angles_are_those_of_the_file(out, recordings):
    columns = table(out / "angles.csv")
    theirs = recordings["straight"].model_outputs["LKneeAngles"][:, 0]
    assert list(columns) == ["time", *(f"{side}_{curve}" for side in SIDES for curve in CURVES)]
    assert np.nanmax(np.abs(columns["left_knee_flexion"] - theirs)) < 0.1


def test_joint_centres_are_those_of_the_file(out, recordings):
    columns = table(out / "joint_centres.csv")
    ours = np.column_stack([columns[f"right_ankle_{axis}"] for axis in "xyz"])
    assert np.nanmax(np.abs(ours - recordings["straight"].model_outputs["RTIO"])) < 1e-4


def test_rows_are_the_stored_frames(out, recordings):
    time = table(out / "angles.csv")["time"]
    walk = recordings["straight"]
    assert time == pytest.approx(np.arange(walk.n_frames) / walk.rate)


def test_result_names_files_events_and_curves(out, recordings):
    result = json.loads((out / "result.json").read_text())
    assert [entry["sha256"] for entry in result["inputs"]] == [recordings[n].sha256 for n in ("static", "straight")]
    assert len(result["events"]) == len(recordings["straight"].events)
    assert all(len(result["kinematics"][curve][side]["mean"]) == 101 for curve in CURVES for side in SIDES)
    assert result["weights"] is None


def test_the_model_weighs_what_the_person_weighs(out, recordings):
    result = json.loads((out / "result.json").read_text())
    masses = [segment["mass_kg"] for segment in result["subject"]["segments"]]
    assert sum(masses) == pytest.approx(recordings["static"].parameters["mass"], rel=1e-3)


def test_walk_arrays_have_one_row_per_frame(out, recordings):
    n = recordings["straight"].n_frames
    with np.load(out / "walk.npz") as walk:
        assert all(len(walk[name]) == n for name in ("time", "q_measured", "markers", "phase", "grf_plates"))
        assert walk["segment_positions_measured"].shape == (n, len(walk["segment_names"]), 3)
        assert walk["bones"].max() < len(walk["segment_names"])


def test_the_model_s_joints_lie_at_the_measured_ones(out):
    columns = table(out / "joint_centres.csv")
    with np.load(out / "walk.npz") as walk:
        names = list(walk["segment_names"])
        knee = walk["segment_positions_measured"][:, names.index("left_shank")]
    measured = np.column_stack([columns[f"left_knee_{axis}"] for axis in "xyz"])
    assert np.sqrt(np.nanmean(np.sum((knee - measured) ** 2, axis=1))) < 0.02


def test_several_walks_have_a_folder_each(files, tmp_path, out):
    (tmp_path / "again.c3d").write_bytes((files / "straight.c3d").read_bytes())
    assert run_on(files, tmp_path / "out", "straight.c3d", tmp_path / "again.c3d") == 0
    assert {path.name for path in (tmp_path / "out" / "again").iterdir()} == FILES
    alone = json.loads((out / "result.json").read_text())
    own = json.loads((tmp_path / "out" / "straight" / "result.json").read_text())
    assert own["kinematics"] == alone["kinematics"]


def test_given_parameters_replace_those_of_the_file(files, tmp_path):
    arguments = ["analyse", "--static", files / "static.c3d", files / "straight.c3d", "--out", tmp_path, "--mass", 99]
    assert run([*map(str, arguments), "--no-weights"]) == 0
    assert json.loads((tmp_path / "result.json").read_text())["subject"]["mass_kg"] == 99.0
