import numpy as np
import pytest
from report.page import Page, render
from synthetic_output import document, walk_arrays, write_output

from gaitlab.clinical.document import CURVES, read_document
from gaitlab.errors import OutputError
from gaitlab.report.edition import INTENDED_USE
from gaitlab.report.files import write_preview
from gaitlab.report.pages import MOST_TRIALS

ADDRESSES = ("src", "href", "xlink:href", "action", "data", "poster", "srcset")
HOSTILE = '</style><script>alert(1)</script><img src=x onerror="alert(2)">&amp;'


@pytest.fixture(scope="module")
def words_of_one_walk(tmp_path_factory):
    return Page(render(write_output(tmp_path_factory.mktemp("out"), document(), walk_arrays()))).text


def test_the_synthetic_document_keeps_the_contract(one_walk):
    assert read_document(one_walk / "result.json").weights is not None


def test_the_page_needs_nothing_from_outside(one_walk):
    markup = write_preview(one_walk).read_text()
    page = Page(markup)
    addresses = [value for name in ADDRESSES for value in page.attributes(name)]
    assert not [value for value in addresses if not value.startswith("#")]
    assert "script" not in page.tags() and "url(" not in markup and "@import" not in markup and "://" not in markup


def test_the_page_is_well_formed_and_small(two_walks):
    markup = write_preview(two_walks).read_text()
    page = Page(markup)
    assert not page.unclosed and not page.open
    assert len(markup) < 1_500_000


def test_the_same_directory_gives_the_same_bytes(one_walk):
    first = write_preview(one_walk).read_bytes()
    assert write_preview(one_walk).read_bytes() == first


def test_all_nine_curves_are_drawn_for_both_sides(one_walk):
    markup = render(one_walk)
    assert set(CURVES) <= set(Page(markup).attributes("data-curve"))
    for name in CURVES:
        panel = markup.split(f'data-curve="{name}"')[1].split("</g>")[0]
        assert panel.count("<path") == 2


@pytest.mark.parametrize(
    "words",
    [
        INTENDED_USE,
        "LKNE is missing from 0.20 s to 0.25 s and was filled",
        "a" * 64,
        "not identifiable",
        "share of a model's cost, not a cause",
        "equal weights",
        "KKT residual",
        "positive definite",
        "Ext / Flex [deg]",
        "Step length [m]",
        "Estimated, neither measured nor given: height.",
        "9.4 mm rms",
        "0.1.0",
        "double support 0.40–0.80 s",
    ],
)
def test_the_page_says(words_of_one_walk, words):
    assert words in words_of_one_walk


def test_a_result_that_did_not_converge_is_marked(tmp_path):
    directory = write_output(tmp_path, document(status="not_converged"), walk_arrays())
    text = Page(render(directory)).text
    assert "NOT CONVERGED" in text
    assert text.count("Not converged: what follows is the last iterate, not a result.") >= 2


def test_a_converged_result_is_not_marked(words_of_one_walk):
    assert "not converged" not in words_of_one_walk.lower()


def test_hostile_words_stay_words(tmp_path):
    hostile = document()
    hostile["inputs"][1]["name"] = HOSTILE
    hostile["weights"]["criteria"][0]["name"] = HOSTILE
    hostile["weights"]["fit"]["per_joint"] = {HOSTILE: 0.1}
    hostile["settings"] = {HOSTILE: HOSTILE}
    hostile["warnings"] = [HOSTILE]
    arrays = walk_arrays() | {"segment_names": np.array([HOSTILE] * 9), "phase": np.array([HOSTILE] * 241)}
    page = Page(render(write_output(tmp_path / "<b>", hostile, arrays)))
    assert not page.tags() & {"script", "img", "b"} and not page.attributes("onerror")
    assert HOSTILE in page.text and not page.unclosed


@pytest.mark.parametrize("written", [{}, {"version": 3, "inputs": 7, "kinematics": [], "weights": "x", "events": {}}])
def test_a_document_with_nothing_in_it_says_what_is_missing(tmp_path, written):
    text = Page(render(write_output(tmp_path, written, angles=False))).text
    for what in ("joint angles over the gait cycle", "weights of the criteria", "gait events", "spatiotemporal"):
        assert f"Not shown: {what}" in text
    assert "has no walk.npz" in text


@pytest.mark.parametrize("key", sorted(set(walk_arrays()) - {"time"}))
def test_any_array_of_the_walk_may_be_absent(tmp_path, key):
    arrays = {name: array for name, array in walk_arrays().items() if name != key}
    page = render(write_output(tmp_path, document(), arrays, angles=False), "weights", "walk", "stills")
    assert "The walk of the model" in Page(page).text


def test_a_broken_walk_is_said_on_the_page(one_walk):
    (one_walk / "walk.npz").write_bytes(b"no archive")
    assert "not a readable archive" in Page(render(one_walk, "walk")).text


def test_the_page_does_not_give_away_where_it_was_made(tmp_path):
    directory = write_output(tmp_path / "surname", document(), angles=False)
    (directory / "angles.csv").write_text("time\nx\n")
    assert "surname" not in render(directory)


def test_frames_outside_the_stride_are_left_out(tmp_path):
    arrays = walk_arrays()
    arrays["q_optimal"][:100] = np.nan
    text = Page(render(write_output(tmp_path, document(), arrays), "walk")).text
    assert "left single support 1.00–1.20 s" in text


def test_several_walks_have_an_overall_part_and_a_part_each(two_walks):
    page = Page(render(two_walks))
    assert {"trial-1", "trial-2"} <= set(page.attributes("id"))
    assert "sd between strides" in page.text and "Trial: walk_2" in page.text


def test_many_walks_keep_the_page_small(tmp_path):
    directory = write_output(tmp_path, document(), angles=False)
    for number in range(MOST_TRIALS + 2):
        write_output(directory / f"walk_{number}", document(f"walk_{number}"), walk_arrays())
    markup = render(directory)
    assert len(markup) < 1_500_000
    assert f"Not shown: walk_{MOST_TRIALS}, walk_{MOST_TRIALS + 1}." in Page(markup).text


def test_a_directory_without_a_result_is_refused(tmp_path):
    with pytest.raises(
        OutputError, match=r"has no result\.json; give the directory that 'gaitlab analyse --out' wrote"
    ):
        write_preview(tmp_path)


@pytest.mark.parametrize("content", ["{", "[1]"])
def test_a_broken_result_is_refused(tmp_path, content):
    (tmp_path / "result.json").write_text(content)
    with pytest.raises(OutputError, match="run 'gaitlab analyse' again"):
        write_preview(tmp_path)


def test_a_page_that_cannot_be_written_is_refused(one_walk):
    (one_walk / "report.html").mkdir()
    with pytest.raises(OutputError, match="cannot be written"):
        write_preview(one_walk)
