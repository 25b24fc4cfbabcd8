from dataclasses import replace

import numpy as np
import pytest

from gaitlab.errors import InvalidRecording, InvalidSubject
from gaitlab.inverse.static import CalibrationSettings, calibrate, calibrate_subject

pytestmark = pytest.mark.shared_data
OFFSETS = ("thigh_rotation", "shank_rotation", "tibial_torsion", "ankle_abduction", "static_plantar_flexion")


@pytest.mark.parametrize(
    "static", ["fmc_adult/*BP01", "fmc_adult/*BP08", "stairs_adult/Static_trial", "children/HC040A/static*"]
)
def test_measured_offsets_are_those_of_the_file(trial, static):
    static = trial(static)
    calibration = calibrate_subject(static, static, {})
    for side, calibrated in calibration.sides.items():
        assert calibrated.offsets == "static"
        for name in (*OFFSETS, "static_rotation"):
            stored = static.parameters[f"{side}_{name}"]
            assert np.degrees(getattr(calibrated, name)) == pytest.approx(np.degrees(stored), abs=0.01), (side, name)


@pytest.mark.parametrize(
    ("static", "method", "flat"),
    [
        ("fmc_adult/*BP01", "knee alignment device", True),
        ("fmc_adult/*BP08", "medial markers", True),
        ("stairs_adult/Static_trial", "wands", False),
        ("children/HC030A/static*", "wands", True),
    ],
)
def test_method_and_flat_foot_are_recognised(trial, static, method, flat):
    static = trial(static)
    sides = calibrate_subject(static, static, {}).sides
    assert {side.method for side in sides.values()} == {method}
    assert {side.foot_flat for side in sides.values()} == {flat}


def test_without_medial_ankle_marker_the_given_torsion_leads_to_the_same_shank(trial):
    static = trial("fmc_adult/*BP01")
    bare = replace(static, markers={n: m for n, m in static.markers.items() if n not in ("LMED", "RMED")})
    for side, calibrated in calibrate_subject(bare, static, {}).sides.items():
        stored = static.parameters[f"{side}_shank_rotation"]
        assert np.degrees(calibrated.shank_rotation) == pytest.approx(np.degrees(stored), abs=0.2)


def test_wrong_choice_of_flat_foot_shows(trial):
    static = trial("stairs_adult/Static_trial")
    wrong = CalibrationSettings(left_foot_flat=True, right_foot_flat=True)
    sides = calibrate_subject(static, static, {}, wrong).sides
    assert abs(sides["right"].static_plantar_flexion - static.parameters["right_static_plantar_flexion"]) > 0.03


def test_another_static_than_the_walk_was_processed_with_is_reported(trial):
    calibration = calibrate_subject(trial("fmc_adult/*BP01"), trial("fmc_adult/*BP15"), {})
    assert any("another static" in warning for warning in calibration.warnings)


def test_the_right_static_is_not_reported(trial):
    calibration = calibrate_subject(trial("fmc_adult/*BP08"), trial("fmc_adult/*BP15"), {})
    assert not any("another static" in warning for warning in calibration.warnings)


def test_file_without_offsets_falls_back_to_the_static(trial):
    static = trial("children/HC030A/static*")
    lengths = {n: v for n, v in static.parameters.items() if "static_" not in n}
    bare = replace(static, parameters=lengths)
    sides = calibrate_subject(bare, bare, {}, CalibrationSettings(offsets="file")).sides
    assert sides["left"].offsets == "static"
    assert sides["left"].static_plantar_flexion == pytest.approx(
        static.parameters["left_static_plantar_flexion"], abs=1e-4
    )


def test_nothing_known_about_the_foot_is_said(trial):
    walk = trial("ktk_walk/walk")
    lengths = {n: v for n, v in walk.parameters.items() if "static_" not in n}
    calibration = calibrate_subject(None, replace(walk, parameters=lengths), {})
    assert calibration.sides["left"].offsets == "none"
    assert any("unknown offset" in warning for warning in calibration.warnings)


def test_missing_measurements_are_named(trial):
    static = trial("children/HC030A/static*")
    parameters = {n: v for n, v in static.parameters.items() if n != "left_knee_width"}
    with pytest.raises(InvalidSubject, match="left_knee_width"):
        calibrate(static, parameters)


def test_static_markers_never_seen_together_are_refused(trial):
    static = trial("children/HC030A/static*")
    late = np.arange(static.n_frames)[:, None] > static.n_frames // 2
    markers = dict(static.markers)
    markers |= {"LHEE": np.where(late, np.nan, markers["LHEE"]), "LTOE": np.where(late, markers["LTOE"], np.nan)}
    with pytest.raises(InvalidRecording, match="never seen together"):
        calibrate_subject(replace(static, markers=markers), static, {})
