import datetime

import pytest

from gaitlab.clinical.examination import encode_examination, read_examination
from gaitlab.errors import InvalidSubject

TOML = """
[patient]
pseudonym = "P-017"
gmfcs = 2
[session]
date = 2026-11-20
[condition]
footwear = "barefoot"
[[ranges]]
joint = "hip"
motion = "flexion"
left = 110
[[strength]]
muscle = "quadriceps"
left = 4
right = "4+"
[[spasticity]]
muscle = "gastrocnemius"
right = "1+"
"""


def written(tmp_path, text, name="examination.toml"):
    path = tmp_path / name
    path.write_text(text)
    return path


def test_toml_and_its_json_say_the_same(tmp_path):
    found = read_examination(written(tmp_path, TOML))
    assert found.patient.pseudonym == "P-017" and found.session.date == datetime.date(2026, 11, 20)
    assert found.ranges[0].left == 110.0 and found.ranges[0].right is None
    assert (found.strength[0].left, found.spasticity[0].right) == (4, "1+")
    json = written(tmp_path, encode_examination(found).decode(), "examination.json")
    assert read_examination(json) == found


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('pseudonym = "P-017"', 'name = "Somebody"', "no name or birth date of a person"),
        ("gmfcs = 2", "gmfcs = 6", "gmfcs"),
        ("left = 110", "left = 1100", "hip flexion is 1100 deg"),
        ("left = 4\n", "left = 7\n", "strength of quadriceps is 7: give 0 to 5"),
        ('right = "1+"', 'right = "5"', "spasticity of gastrocnemius is 5: give 0, 1, 1+"),
        ("[patient]", "[patient", "examination.toml"),
    ],
)
def test_what_no_scale_has_is_refused(tmp_path, old, new, words):
    with pytest.raises(InvalidSubject) as caught:
        read_examination(written(tmp_path, TOML.replace(old, new)))
    assert words in str(caught.value)


def test_an_absent_file_is_told(tmp_path):
    with pytest.raises(InvalidSubject, match=r"x\.toml cannot be read"):
        read_examination(tmp_path / "x.toml")
