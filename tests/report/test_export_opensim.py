import numpy as np
import pytest
from exported_trial import HEADING, RATE, SEGMENTS, N, arrays, exported_trial, turn

from gaitlab.errors import OutputError
from gaitlab.report.export_opensim import export_coordinates, export_ground_reactions, export_trc, to_opensim


@pytest.fixture
def folder(tmp_path):
    return exported_trial(tmp_path / "result")


def read_trc(path):
    """A reader of its own, strict about the six header lines and the number of tabs."""
    lines = path.read_text().split("\n")
    assert lines[0] == f"PathFileType\t4\t(X/Y/Z)\t{path.name}" and lines[-1] == ""
    names, values = lines[1].split("\t"), lines[2].split("\t")
    labels = lines[3].split("\t")
    assert labels[:2] == ["Frame#", "Time"] and lines[4].startswith("\t\tX1\tY1\tZ1\tX2") and lines[5] == ""
    rows = [line.split("\t") for line in lines[6:-1]]
    markers = labels[2::3]
    assert {len(row) for row in rows} == {2 + 3 * len(markers)} == {len(lines[4].split("\t"))}
    table = np.array([[float(cell) for cell in row] for row in rows])
    return dict(zip(names, values, strict=True)), markers, table


def read_motion(path):
    lines = path.read_text().split("\n")
    end = lines.index("endheader")
    head = dict(line.split("=") for line in lines[1:end] if "=" in line)
    labels = lines[end + 1].split("\t")
    table = np.array([[float(cell) for cell in line.split("\t")] for line in lines[end + 2 : -1]])
    assert (int(head["nRows"]), int(head["nColumns"])) == table.shape and len(labels) == table.shape[1]
    return lines[0], head, labels, table


def test_axes_are_forward_up_right():
    heading = 0.3
    forward, left = turn(heading) @ [1.0, 0.0, 0.0], turn(heading) @ [0.0, 1.0, 0.0]
    turned = to_opensim(np.stack([forward, left, [0.0, 0.0, 1.0]]), heading)
    assert turned == pytest.approx(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]))


def test_markers_in_millimetres_of_opensim(folder, tmp_path):
    export_trc(folder, tmp_path / "walk.trc")
    head, markers, table = read_trc(tmp_path / "walk.trc")
    assert markers == ["LASI", "RASI"]
    assert (head["Units"], int(head["NumFrames"]), int(head["NumMarkers"])) == ("mm", N, 2)
    assert float(head["DataRate"]) == pytest.approx(RATE)
    q = arrays()["q_measured"]
    assert table[:, 1] == pytest.approx(np.arange(N) / RATE, abs=1e-6)
    assert table[:, 2:5] == pytest.approx(1000.0 * np.column_stack([q[:, 0], q[:, 2], -q[:, 1]]), abs=1e-4)


def test_a_missing_marker_is_no_number(folder, tmp_path):
    export_trc(folder, tmp_path / "walk.trc")
    table = read_trc(tmp_path / "walk.trc")[2]
    assert np.isnan(table[7, 5:8]).all() and np.isfinite(np.delete(table, 7, axis=0)).all()


def test_coordinates_have_the_names_of_the_model(folder, tmp_path):
    export_coordinates(folder, tmp_path / "q.mot")
    name, head, labels, table = read_motion(tmp_path / "q.mot")
    assert (name, head["inDegrees"]) == ("Coordinates", "yes")
    assert labels[:5] == ["time", "pelvis_tx", "pelvis_ty", "pelvis_tz", "pelvis_y"]
    assert labels[4:] == [f"{segment}_{axis}" for segment in SEGMENTS for axis in "yxz"]
    q = arrays()["q_measured"]
    assert table[:, 1:4] == pytest.approx(q[:, :3], abs=1e-6)
    assert table[:, 4:] == pytest.approx(np.degrees(q[:, 3:]), abs=1e-5)


def test_plates_give_force_point_and_moment(folder, tmp_path):
    export_ground_reactions(folder, tmp_path / "plates.mot")
    _, head, labels, table = read_motion(tmp_path / "plates.mot")
    assert head["inDegrees"] == "no"
    assert labels[1:] == [f"ground_{kind}_1_{letter}{axis}" for kind, letter in KINDS for axis in "xyz"]
    row = table[30, 1:]
    assert row[:3] == pytest.approx([50.0, 600.0, 20.0], abs=1e-5)  # (x, z, -y) of the gait frame
    assert row[3:6] == pytest.approx([0.2, 0.0, -0.1], abs=1e-6)
    assert row[6:] == pytest.approx([0.0, -3.0, 0.0])
    assert not table[5, 1:].any()


KINDS = (("force", "v"), ("force", "p"), ("moment", "m"))


def test_coordinates_that_do_not_fit_the_positions_are_refused(folder, tmp_path):
    changed = arrays()
    changed["segment_positions_measured"] += 0.01
    np.savez(folder / "walk.npz", **changed)
    with pytest.raises(OutputError, match="do not belong together"):
        export_trc(folder, tmp_path / "walk.trc")
    assert HEADING != 0.0


@pytest.mark.parametrize(
    ("missing", "exporter", "words"),
    [
        ("markers", export_trc, "holds no markers"),
        ("q_measured", export_coordinates, "holds no q_measured"),
        ("free_moment_plates", export_ground_reactions, "no force plates with free moments"),
        ("segment_names", export_coordinates, "names 0 segments"),
    ],
)
def test_what_is_missing_is_said(folder, tmp_path, missing, exporter, words):
    np.savez(folder / "walk.npz", **{name: value for name, value in arrays().items() if name != missing})
    with pytest.raises(OutputError, match=words):
        exporter(folder, tmp_path / "file.mot")
