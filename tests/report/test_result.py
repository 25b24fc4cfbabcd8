import numpy as np
import pytest
from synthetic_output import document, write_output

from gaitlab.report.result import read_result, real, trial_directories


@pytest.mark.parametrize("value", [None, True, "1.0", float("nan"), float("inf"), [1.0]])
def test_only_finite_numbers_are_numbers(value):
    assert real(value) is None


def test_curves_may_be_plain_lists_with_gaps(tmp_path):
    written = document()
    written["kinematics"] = {"hip_flexion": {"left": [None, *range(100)], "right": [1.0, 2.0]}}
    curves = read_result(write_output(tmp_path, written)).kinematics["hip_flexion"]
    assert np.isnan(curves["left"].mean[0]) and curves["left"].mean[100] == 99.0
    assert "right" not in curves


def test_events_that_make_no_sense_are_left_out(tmp_path):
    written = document()
    good = {"side": "left", "kind": "foot_off", "time_s": 1.0, "source": "file"}
    written["events"] = [good, good | {"side": "up"}, good | {"time_s": None}, "event"]
    assert [event.source for event in read_result(write_output(tmp_path, written)).events] == ["file"]


def test_a_report_of_one_walk_is_named_after_its_file(tmp_path):
    assert read_result(write_output(tmp_path, document("stride_7"))).name == "stride_7"


def test_trials_are_found_in_order(two_walks):
    assert [path.name for path in trial_directories(two_walks)] == ["walk_1", "walk_2"]
    assert trial_directories(two_walks / "walk_1") == (two_walks / "walk_1",)
