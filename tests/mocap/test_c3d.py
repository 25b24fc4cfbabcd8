import hashlib
from dataclasses import replace

import ezc3d
import numpy as np
import pytest
from synthetic_walk import Gait, rectangle, synthetic_walk, with_plate, write_variant

from gaitlab.errors import InvalidRecording, OutputError
from gaitlab.mocap.c3d import extract, read_c3d, write_c3d
from gaitlab.mocap.events import detect_events
from gaitlab.mocap.labels import require_markers

WALK = with_plate(synthetic_walk(Gait(duration=2.5)), 0.5, 1.1, rectangle(0.2, 0.3))


@pytest.fixture
def path(tmp_path):
    return tmp_path / "walk.c3d"


def assert_same_walk(read, tolerance=1e-6):
    assert set(read.markers) == set(WALK.markers)
    assert (read.rate, read.first_frame, read.n_frames) == (WALK.rate, WALK.first_frame, WALK.n_frames)
    for name, positions in WALK.markers.items():
        assert read.markers[name] == pytest.approx(positions, abs=tolerance)
    for event, true in zip(read.events, WALK.events, strict=True):
        assert (event.side, event.kind, event.source) == (true.side, true.kind, "file")
        assert event.time == pytest.approx(true.time, abs=1e-5)
    assert read.parameters == pytest.approx(WALK.parameters)
    (plate,), (true_plate,) = read.force_plates, WALK.force_plates
    assert plate.force == pytest.approx(true_plate.force, abs=1e-4)
    assert plate.corners == pytest.approx(true_plate.corners, abs=1e-6)


def rename(function):
    def change(c3d):
        labels = c3d["parameters"]["POINT"]["LABELS"]
        labels["value"] = [function(label) for label in labels["value"]]

    return change


def metres(c3d):
    """Positions and plate in metres, moments in N*m."""
    c3d["data"]["points"][:3] *= 1e-3
    c3d["data"]["analogs"][0, 3:6] *= 1e-3
    c3d["parameters"]["POINT"]["UNITS"]["value"] = ["m"]
    c3d["parameters"]["ANALOG"]["UNITS"]["value"] = ["N", "N", "N", "Nm", "Nm", "Nm"]
    c3d["parameters"]["FORCE_PLATFORM"]["CORNERS"]["value"] *= 1e-3


def labels_in_two_parameters(c3d):
    labels = c3d["parameters"]["POINT"]["LABELS"]["value"]
    c3d["parameters"]["POINT"]["LABELS"]["value"] = labels[:10]
    c3d.add_parameter("POINT", "LABELS2", labels[10:])


def upright_y(c3d):
    """The file's y axis points up: (x, y, z) of ours becomes (x, z, -y)."""
    turn = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    c3d["data"]["points"][:3] = np.einsum("ij,jkn->ikn", turn, c3d["data"]["points"][:3])
    corners = c3d["parameters"]["FORCE_PLATFORM"]["CORNERS"]
    corners["value"] = np.einsum("ij,jkn->ikn", turn, corners["value"])


@pytest.mark.parametrize(
    "change",
    [
        lambda c3d: None,
        rename(lambda label: f"P01:{label}"),
        rename(lambda label: f"{label}_M"),
        rename(str.lower),
        rename(lambda label: {"LASI": "LASIS", "RHEE": "RHEEL", "LKNE": "L_KNEE"}.get(label, label)),
        metres,
        labels_in_two_parameters,
        upright_y,
    ],
    ids=["as written", "prefix", "suffix", "lower case", "aliases", "metres", "LABELS2", "y up"],
)
def test_variants_of_one_walk_read_the_same(path, change):
    assert_same_walk(read_c3d(write_variant(path, WALK, change)))


def test_missing_parameters_plates_and_events(path):
    bare = replace(WALK, parameters={}, force_plates=(), events=())
    write_c3d(path, bare)
    read = read_c3d(path)
    assert (read.parameters, read.force_plates, read.events, dict(read.analog)) == ({}, (), (), {})
    assert len(detect_events(read)) >= 7


def test_missing_positions_stay_missing(path):
    hidden = WALK.markers["LHEE"].copy()
    hidden[20:50] = np.nan
    write_c3d(path, replace(WALK, markers={**WALK.markers, "LHEE": hidden}))
    np.testing.assert_array_equal(np.isnan(read_c3d(path).markers["LHEE"]), np.isnan(hidden))


def test_the_same_recording_gives_the_same_bytes(tmp_path):
    paths = [tmp_path / "a.c3d", tmp_path / "b.c3d"]
    for path in paths:
        write_c3d(path, WALK)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    assert read_c3d(paths[0]).sha256 == hashlib.sha256(paths[1].read_bytes()).hexdigest()


def test_unwritable_folder(tmp_path):
    with pytest.raises(OutputError, match="the C3D file cannot be written"):
        write_c3d(tmp_path / "none" / "walk.c3d", WALK)


def test_no_markers(path):
    def only_outputs(c3d):
        count = len(c3d["parameters"]["POINT"]["LABELS"]["value"])
        c3d["parameters"]["POINT"]["LABELS"]["value"] = [f"L{k}Angles" for k in range(count)]

    with pytest.raises(InvalidRecording, match="walk: the C3D file holds no markers, only model outputs"):
        read_c3d(write_variant(path, WALK, only_outputs))


def test_nothing_but_missing_positions(path):
    write_c3d(path, replace(WALK, markers={name: np.full_like(x, np.nan) for name, x in WALK.markers.items()}))
    read = read_c3d(path)
    with pytest.raises(InvalidRecording, match="walk: no marker is ever visible"):
        require_markers(read.name, read.markers)
    with pytest.raises(InvalidRecording, match="no pelvis marker"):
        detect_events(read)


@pytest.mark.shared_data
def test_every_real_recording_reads(real_recordings):
    assert len(real_recordings) == 25
    for read in real_recordings.values():
        assert {"LASI", "RANK", "RHEE", "LTOE"} <= set(read.markers)
        assert not any(name.endswith(("Angles", "Moment", "Power", "Force")) for name in read.markers)
        assert {"LFEP", "LHipAngles", "RKneeAngles"} <= set(read.model_outputs)
        assert read.parameters["mass"] > 20.0
        assert 0.3 < read.parameters["left_leg_length"] < 1.1


@pytest.mark.shared_data
@pytest.mark.parametrize("name", ["fmc_adult/MH0222_BP06.c3d", "children/HC040A/straight_HC040A14.c3d"])
def test_positions_are_those_of_the_file(shared_data, real_recordings, name):
    file = ezc3d.c3d(str(shared_data / name))
    read = real_recordings[name.rpartition("/")[2]]
    labels = file["parameters"]["POINT"]["LABELS"]["value"]
    for point in ("LASI", "RHEE", "LFEP"):
        stored = file["data"]["points"][:3, labels.index(point)].T
        ours = {**read.markers, **read.model_outputs}[point]
        seen = np.isfinite(ours).all(axis=1)
        assert ours[seen] == pytest.approx(1e-3 * stored[seen])
        assert (np.isnan(stored[~seen]) | (stored[~seen] == 0)).all()


@pytest.mark.shared_data
def test_extracting_in_this_process(shared_data):
    raw = extract(shared_data / "fmc_adult" / "MH0222_BP06.c3d")
    assert (raw.points.shape, raw.analog.shape, raw.first_frame) == ((279, 90, 3), (2790, 24), 397)
    assert raw.numbers("FORCE_PLATFORM", "CORNERS").shape == (3, 4, 4)
