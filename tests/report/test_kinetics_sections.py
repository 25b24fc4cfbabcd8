import numpy as np
import pytest
from report.page import Page, render
from synthetic_output import document, walk_arrays, write_output

from gaitlab.clinical.kinetics_document import UNITS
from gaitlab.report.kinetics_figure import PANELS

REASON = "walk_1: no kinetics of the right side, its foot has no valid contact with a force plate"


def averages(value, n_cycles=2):
    return {"mean": np.full(101, value).tolist(), "sd": np.full(101, 0.1).tolist(), "n_cycles": n_cycles}


def written(curves=True):
    contact = {"trial": "walk_1", "plate": 1, "start_s": 0.6, "end_s": 1.2, "side": "left", "accepted": True}
    rejected = contact | {"plate": 2, "side": "right", "accepted": False, "reason": "the left foot stood on it too"}
    kinetics = {
        "curves": {name: {"unit": unit, "left": averages(0.5)} for name, unit in UNITS.items()} if curves else {},
        "moments_in": "the axes of the segment below the joint",
        "inertia": "the subject's model",
        "contacts": [contact | {"reason": ""}, rejected],
        "missing": [REASON],
    }
    emg = {"envelopes": {"Voltage.L Rect": {"unit": "V", "left": averages(0.002)}}, "filter": "band-pass 20-450 Hz"}
    return document() | {"kinetics": kinetics, "emg": emg}


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    return render(write_output(tmp_path_factory.mktemp("out"), written(), walk_arrays()))


@pytest.mark.parametrize(
    "words",
    [
        "Number of cycles with a valid plate contact: left 2, right 0.",
        "Flexor / Extensor [N·m/kg]",
        "Dorsi / Plantar [N·m/kg]",
        "Absorbed / Generated [W/kg]",
        "Up [% body weight]",
        "expressed in the axes of the segment below the joint; inertia of the subject's model",
        "an internal extensor moment is an external flexor moment",
        REASON,
        "not used: the left foot stood on it too",
        "Voltage.L Rect",
        "% of 0.002 V",
        "band-pass 20-450 Hz",
    ],
)
def test_the_page_says(page, words):
    assert words in Page(page).text


def test_every_panel_is_drawn_for_the_side_that_has_it(page):
    for panel in PANELS:
        markup = page.split(f'data-curve="{panel.name}"')[1].split("</g>")[0]
        assert markup.count("<path") == 1


def test_without_any_curve_the_reason_stands_there(tmp_path):
    text = Page(render(write_output(tmp_path, written(curves=False), walk_arrays()))).text
    assert f"Not shown: moments, powers and ground reactions. Reason: {REASON}" in text
    assert "Contacts with the force plates" in text


def test_an_old_result_says_that_it_holds_no_kinetics(tmp_path):
    text = Page(render(write_output(tmp_path, document(), walk_arrays()))).text
    assert "Not shown: moments, powers and ground reactions. Reason: result.json holds none" in text
    assert "Not shown: muscle activity. Reason: result.json holds none" in text


def test_a_curve_that_leaves_its_scale_is_told(tmp_path):
    strong = written()
    strong["kinetics"]["curves"]["hip_power"]["left"] = averages(9.5)
    assert "leaves scale: 9.50 to 9.50" in Page(render(write_output(tmp_path, strong, walk_arrays()))).text


def test_hostile_labels_stay_words(tmp_path):
    hostile = written()
    hostile["emg"]["envelopes"] = {'"><script>x</script>': {"left": averages(1.0)}}
    hostile["kinetics"]["missing"] = ["<img src=x>"]
    page = Page(render(write_output(tmp_path, hostile, walk_arrays())))
    assert not page.tags() & {"script", "img"} and not page.unclosed
