from dataclasses import replace

import numpy as np
import pytest

from gaitlab.errors import InvalidSubject
from gaitlab.inverse.conventional_calibration import newington_hip_centre
from gaitlab.inverse.static_parameters import body_measurements
from gaitlab.mocap.recording import Recording

STANDING = {
    "LASI": [0.1, 0.11, 0.9],
    "RASI": [0.1, -0.11, 0.9],
    "LKNE": [0.0, 0.15, 0.45],
    "RKNE": [0.0, -0.15, 0.45],
    "LKNM": [0.0, 0.04, 0.45],
    "RKNM": [0.0, -0.04, 0.45],
    "LANK": [0.0, 0.13, 0.08],
    "RANK": [0.0, -0.13, 0.08],
    "LMED": [0.0, 0.05, 0.09],
}


def standing(markers=STANDING, **parameters):
    frames = {name: np.tile(position, (4, 1)) for name, position in markers.items()}
    return Recording(name="static", sha256="", rate=100.0, first_frame=0, markers=frames, parameters=parameters)


def test_nothing_known_is_refused():
    with pytest.raises(InvalidSubject, match="neither a static trial nor any body measurement"):
        body_measurements({}, None, standing())


@pytest.mark.parametrize("name", ["mass", "height", "left_leg_length", "right_knee_width", "marker_diameter"])
def test_zero_is_refused(name):
    with pytest.raises(InvalidSubject, match=f"{name} is 0"):
        body_measurements({name: 0.0}, standing())


def test_everything_is_estimated_from_a_static():
    values = body_measurements({}, standing()).values
    assert values["inter_asis_distance"] == pytest.approx(0.22)
    assert values["left_leg_length"] == pytest.approx(np.hypot(0.45, np.hypot(0.1, 0.04)) + np.hypot(0.37, 0.02))
    assert values["left_knee_width"] == pytest.approx(0.11 - 0.014)
    assert values["left_asis_trochanter"] == pytest.approx(0.1288 * values["left_leg_length"] - 0.04856)


def test_estimates_are_reported():
    warnings = " ".join(body_measurements({"left_leg_length": 0.8}, standing()).warnings)
    for words in ("marker diameter", "right leg length", "as on the left", "left knee width"):
        assert words in warnings


def test_other_side_is_copied():
    values = body_measurements({"left_ankle_width": 0.07}, standing()).values
    assert values["right_ankle_width"] == 0.07


def test_given_wins_over_walk_and_walk_over_static():
    static, walk = standing(mass=40.0, height=1.4, left_leg_length=0.7), standing(mass=41.0, height=1.5)
    values = body_measurements({"mass": 42.0}, static, walk).values
    assert (values["mass"], values["height"], values["left_leg_length"]) == (42.0, 1.5, 0.7)


def test_disagreement_of_static_and_walk_is_reported():
    warnings = body_measurements({}, standing(mass=40.0), standing(mass=50.0)).warnings
    assert any("static and walk hold different measurements" in warning for warning in warnings)


def test_widths_without_medial_markers_follow_leg_length():
    bare = {name: position for name, position in STANDING.items() if name[1:] not in ("KNM", "MED")}
    values = body_measurements({"left_leg_length": 0.8}, standing(bare)).values
    assert values["left_knee_width"] == pytest.approx(0.132 * 0.8)


def test_stored_knee_centres_tell_the_marker_diameter():
    centre = np.tile([0.0, 0.10, 0.45], (4, 1))  # 50 mm from LKNE
    walk = replace(standing(left_knee_width=0.09), model_outputs={"LFEO": centre})
    assert body_measurements({}, standing(), walk).values["marker_diameter"] == pytest.approx(0.010)


def test_hip_centre_of_a_textbook_leg():
    """Numbers of a child's file: leg 830 mm, ASIS to trochanter 58.344 mm, ASIS 204 mm apart, markers of 10 mm."""
    centre = newington_hip_centre(0.83, 0.05834400177, 0.204, 0.005)
    np.testing.assert_allclose(1e3 * centre, [-38.52178, 63.57404, -86.46388], atol=1e-4)
