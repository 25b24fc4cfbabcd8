"""The command's kinetics when plates are missing or of no use: the report is still made and says why."""

import json
from dataclasses import replace

import numpy as np
import pytest
from report.page import render

pytestmark = pytest.mark.shared_data


@pytest.fixture
def analysed(gaitlab, reads, recordings, tmp_path):
    """Result and report of the child's walk after a change to its recording."""

    def run(change, *options):
        reads(static=recordings["static"], walk=change(recordings["straight"]))
        arguments = ["--static", "static.c3d", "walk.c3d", "--out", tmp_path / "out", "--no-weights", *options]
        code, _, err = gaitlab("analyse", *arguments)
        assert code == 0, err
        return json.loads((tmp_path / "out" / "result.json").read_text()), render(tmp_path / "out")

    return run


def test_without_plates(analysed, tmp_path):
    result, page = analysed(lambda walk: replace(walk, force_plates=()))
    assert result["kinetics"]["curves"] == {}
    assert "the file holds no usable force plate" in result["kinetics"]["missing"][0]
    assert "the file holds no usable force plate" in page
    assert not (tmp_path / "out" / "kinetics.csv").exists()


def test_plates_without_feet(analysed):
    def far(walk):
        plates = [replace(plate, corners=plate.corners + [9.0, 9.0, 0.0]) for plate in walk.force_plates]
        return replace(walk, force_plates=tuple(plates))

    result, page = analysed(far)
    assert result["kinetics"]["curves"] == {} and len(result["kinetics"]["missing"]) == 2
    assert all("no foot is above" in contact["reason"] for contact in result["kinetics"]["contacts"])
    assert sum("no foot is above" in warning for warning in result["warnings"]) == 2
    assert "no valid contact with a force plate" in page


def test_one_side_only(analysed):
    result, page = analysed(lambda walk: replace(walk, force_plates=walk.force_plates[:1]))
    curve = result["kinetics"]["curves"]["hip_power"]
    assert curve["left"]["n_cycles"] == 1 and curve["right"] is None
    assert "no kinetics of the right side" in page and "left 1, right 0" in page


def test_the_frame_of_moments_is_a_choice(analysed):
    distal, _ = analysed(lambda walk: walk)
    proximal, page = analysed(lambda walk: walk, "--moments-in", "proximal")
    curves = [np.array(r["kinetics"]["curves"]["hip_extensor_moment"]["left"]["mean"]) for r in (distal, proximal)]
    assert np.abs(curves[0] - curves[1]).max() > 0.02
    assert "the axes of the segment above the joint" in page


def test_envelopes_have_the_unit_that_the_file_states(analysed):
    result, _ = analysed(lambda walk: walk)
    assert {curve["unit"] for curve in result["emg"]["envelopes"].values()} == {"V"}
    unstated, _ = analysed(lambda walk: replace(walk, analog_units={}))
    assert {curve["unit"] for curve in unstated["emg"]["envelopes"].values()} == {"file's unit"}
