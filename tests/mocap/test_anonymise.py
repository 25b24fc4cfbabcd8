import ezc3d
import numpy as np
import pytest

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.anonymise import blank_personal_entries
from gaitlab.mocap.c3d import extract
from gaitlab.mocap.privacy import privacy_warnings


@pytest.fixture
def named_file(tmp_path):
    """A C3D file that says who was recorded, in each of the places where systems put it."""
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = ["Jane:LASI", "Jane:RASI"]
    points = np.arange(40.0).reshape(4, 2, 5)
    points[3] = 1.0
    file["data"]["points"] = points
    file.add_parameter("SUBJECTS", "NAMES", ["Jane Doe"])
    file.add_parameter("SUBJECTS", "LABEL_PREFIXES", ["Jane:"])
    file.add_parameter("CLINIC", "PATIENT_ID", [4711.0])
    file.add_parameter("CLINIC", "DATE_OF_BIRTH", ["1.2.2003"])
    file.add_parameter("CLINIC", "DEVICE", ["plate 3"])
    path = tmp_path / "walk.c3d"
    file.write(str(path))
    return path


def test_names_and_dates_are_gone_and_the_data_stay(named_file):
    before = extract(named_file)
    assert privacy_warnings(before)
    changed = blank_personal_entries(named_file)
    content, after = named_file.read_bytes(), extract(named_file)
    assert not any(secret in content for secret in (b"Jane", b"Doe", b"2003"))
    assert privacy_warnings(after) == ()
    assert set(changed) == {
        "POINT:LABELS",
        "SUBJECTS:NAMES",
        "SUBJECTS:LABEL_PREFIXES",
        "CLINIC:PATIENT_ID",
        "CLINIC:DATE_OF_BIRTH",
    }
    assert after.labels == ("LASI", "RASI") and after.texts("CLINIC", "DEVICE") == ("plate 3",)
    np.testing.assert_array_equal(after.points, before.points)


def test_a_second_time_finds_nothing(named_file):
    blank_personal_entries(named_file)
    assert blank_personal_entries(named_file) == ()


@pytest.mark.parametrize("content", [b"", b"no C3D", b"\x02\x50" + bytes(600)])
def test_what_is_no_c3d_file_is_refused_or_left(tmp_path, content):
    path = tmp_path / "x.c3d"
    path.write_bytes(content)
    if len(content) < 512:
        with pytest.raises(InvalidRecording, match="not a C3D file"):
            blank_personal_entries(path)
    else:
        assert blank_personal_entries(path) == ()
    assert path.read_bytes() == content


def test_damaged_sections_end_in_one_sentence(named_file):
    """Every byte of the parameters is damaged once; the walk through them ends, whatever it meets."""
    original = named_file.read_bytes()
    random, ends = np.random.default_rng(1), {"blanked": 0, "refused": 0}
    for place in random.integers(512, 1536, 400):
        damaged = bytearray(original)
        damaged[place] = random.integers(0, 256)
        named_file.write_bytes(damaged)
        try:
            blank_personal_entries(named_file)
            ends["blanked"] += 1
        except InvalidRecording as error:
            assert "damaged" in str(error)
            ends["refused"] += 1
    assert ends["blanked"] > 0 and ends["refused"] > 0
