from pathlib import Path

import pytest
from report.page import Page, render
from synthetic_output import document, walk_arrays, write_output

from gaitlab.clinical.examination import encode_examination, read_examination
from gaitlab.report.source import EXAMINATION

EXAMPLE = Path(__file__).parents[2] / "docs" / "examination.toml"


@pytest.fixture
def examined(tmp_path):
    folder = write_output(tmp_path, document(), walk_arrays())
    (folder / EXAMINATION).write_bytes(encode_examination(read_examination(EXAMPLE)))
    return folder


def test_ranges_strength_and_spasticity_stand_beside_the_curves(examined):
    text = Page(render(examined, "kinematics")).text
    assert "hip flexion, passive [deg] 110 115" in text and "quadriceps, strength (0 to 5) 4 4+" in text
    assert "gastrocnemius, modified Ashworth 1+ 2" in text and "GMFCS level II." in text


def test_they_have_a_page_of_their_own_with_remarks(examined):
    text = Page(render(examined, "examination")).text
    assert "ankle dorsiflexion, knee extended -5 0 left: firm end feel" in text and "GMFCS level II" in text


def test_without_an_examination_the_curves_stand_alone(tmp_path):
    text = Page(render(write_output(tmp_path, document(), walk_arrays()), "kinematics")).text
    assert "Kinematics" in text and "Clinical examination" not in text
