import numpy as np
import pytest

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.labels import LOWER_BODY, canonical_name, require_markers, sort_labels


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("LASI", "LASI"),
        ("lasi", "LASI"),
        ("LASI_M", "LASI"),
        ("P01_LASI", "LASI"),
        ("R.KNEE", "RKNE"),
        ("LKNEMED", "LKNM"),
        ("RANKMED", "RMED"),
        ("LMMA", "LMMA"),
        ("Sacrum", "SACR"),
        ("RHeel", "RHEE"),
        ("LTHI2", None),
        ("VirtualToe", None),
    ],
)
def test_canonical_names(written, name):
    assert canonical_name(written) == name


def test_model_outputs_are_no_markers():
    labels = ["LASI", "LHipAngles", "LFEP", "PELO", "CentreOfMass", "LKJC", "Odd", "*52", "", "WAND"]
    found = sort_labels(labels, {"SCALARS": ["Odd"], "MODELED_MARKERS": ["LKJC"]})
    assert found.markers == {"LASI": 0, "WAND": 9}
    assert set(found.positions) == {"LFEP", "PELO", "CentreOfMass", "LKJC"}
    assert set(found.outputs) == {"LHipAngles", "Odd"}


def test_a_virtual_marker_of_the_model_is_an_output():
    """With a knee alignment device Nexus stores LKNE as its own result."""
    found = sort_labels(["LKAX", "LKNE"], {"MODELED_MARKERS": ["LKNE"]})
    assert (set(found.markers), set(found.positions)) == ({"LKAX"}, {"LKNE"})


def test_prefixes_of_one_subject_go():
    assert sort_labels(["Anna:LASI", "Anna:LHipAngles", "C7"], {"ANGLES": ["Anna:LHipAngles"]}).markers == {
        "LASI": 0,
        "C7": 2,
    }


def test_a_suffix_on_all_markers_goes():
    """LKNE_M alone would be the medial marker."""
    assert set(sort_labels(["LASI_M", "RASI_M", "LKNE_M"], {}).markers) == {"LASI", "RASI", "LKNE"}
    assert set(sort_labels(["LASI", "LKNE", "LKNE_M"], {}).markers) == {"LASI", "LKNE", "LKNM"}


def test_of_two_subjects_the_first_is_used_and_no_name_is_shown():
    found = sort_labels(["Anna:LASI", "Ben:LASI", "Ben:RASI"], {})
    assert found.markers == {"LASI": 0}
    assert found.warnings == ("the file holds 2 subjects; the markers of the first one are used",)


def test_an_exact_label_wins_over_an_alias():
    assert sort_labels(["LKNEE", "LKNE"], {}).markers == {"LKNE": 1}
    assert sort_labels(["LKNE", "LKNEE"], {}).markers == {"LKNE": 0}


def markers(*names: str) -> dict[str, np.ndarray]:
    return {name: np.ones((2, 3)) for name in names}


@pytest.mark.parametrize("pelvis", [["SACR"], ["LPSI", "RPSI"]])
def test_a_complete_set_passes(pelvis):
    require_markers("walk", markers(*LOWER_BODY, *pelvis))


def test_another_models_markers_give_one_sentence():
    with pytest.raises(InvalidRecording, match=r"walk: required markers are missing: LASI, RASI, .*SACR \(or LPSI"):
        require_markers("walk", markers("R_IAS", "L_IAS", "R_FLE"))


def test_a_marker_that_is_never_seen_is_missing():
    there = markers(*LOWER_BODY, "SACR") | {"LTOE": np.full((2, 3), np.nan)}
    with pytest.raises(InvalidRecording, match="required markers are missing: LTOE; the file has: LANK"):
        require_markers("walk", there)


def test_nothing_ever_seen():
    with pytest.raises(InvalidRecording, match="walk: no marker is ever visible"):
        require_markers("walk", {name: np.full((2, 3), np.nan) for name in LOWER_BODY})
