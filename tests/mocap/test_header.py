import os

import pytest
from synthetic_walk import Gait, synthetic_walk

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.c3d import write_c3d
from gaitlab.mocap.header import check_file, parse_header

LIMIT = 200_000_000


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    path = tmp_path_factory.mktemp("walk") / "walk.c3d"
    write_c3d(path, synthetic_walk(Gait(duration=1.0)))
    return path


def message(path, limit=LIMIT) -> str:
    with pytest.raises(InvalidRecording) as caught:
        check_file(path, limit)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_complete_file_passes(walk):
    check_file(walk, LIMIT)


def test_sizes_are_those_of_the_file(walk):
    content = walk.read_bytes()
    header = parse_header(content[:512], content[512:])
    assert (header.n_points, header.n_frames, header.value_size) == (16, 100, 4)
    assert header.end <= len(content)


def test_missing_file_and_folder(tmp_path):
    assert "there is no such file" in message(tmp_path / "none.c3d")
    assert "this is not a file" in message(tmp_path)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "the file is empty"),
        (b"\x02", "not a C3D file"),
        (b"time,LASI_x,LASI_y\n" * 100, "not a C3D file"),
        (b"\x02\x50" + bytes(100), "truncated inside its header"),
        (b"\x09\x50" + bytes(600), "truncated before its parameters"),
    ],
)
def test_other_content(tmp_path, content, said):
    path = tmp_path / "file.c3d"
    path.write_bytes(content)
    assert said in message(path)


@pytest.mark.parametrize("lost", [1000, 20_000, 25_000])
def test_truncated_file(walk, tmp_path, lost):
    path = tmp_path / "truncated.c3d"
    path.write_bytes(walk.read_bytes()[:-lost])
    assert "the C3D file is truncated" in message(path)


def test_two_gigabytes_are_refused_before_reading(walk, tmp_path):
    path = tmp_path / "huge.c3d"
    path.write_bytes(walk.read_bytes())
    os.truncate(path, 2_000_000_000)  # sparse: takes no space
    assert "the file has 2000 MB, the limit is 200 MB; cut the trial to the walk" in message(path)


def test_fewer_frames_in_the_parameters_than_in_the_header(walk, tmp_path):
    """The header may keep the range of the capture from which the trial was cut."""
    content = bytearray(walk.read_bytes())
    content[8:10] = (20_000).to_bytes(2, "little")
    path = tmp_path / "cut.c3d"
    path.write_bytes(content)
    check_file(path, LIMIT)
