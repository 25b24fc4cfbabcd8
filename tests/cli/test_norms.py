"""Norms and scores by the command, on a real recording, and every way in which they can be missing."""

import json
import math

import numpy as np
import pytest
from report.page import Page

from gaitlab.clinical.document import SIDES
from gaitlab.mocap.cycles import cycles
from gaitlab.pipelines import analyse

pytestmark = pytest.mark.shared_data


@pytest.fixture
def analysed(gaitlab, files, tmp_path):
    """Runs the analysis with more options; returns result and the words of the report."""

    def run(*options):
        walk = files / "straight.c3d"
        arguments = ("analyse", "--static", files / "static.c3d", walk, "--out", tmp_path / "out", "--no-weights")
        code, _, err = gaitlab(*arguments, *options)
        assert code == 0, err
        folder = tmp_path / "out"
        return json.loads((folder / "result.json").read_text()), Page((folder / "report.html").read_text()).text

    return run


def test_an_able_bodied_child_scores_as_one(analysed):
    result, text = analysed("--age", 10)
    scores = result["scores"]
    assert 3.4 <= scores["gps_overall"] <= 8.7
    assert set(scores["left"]["gvs"]) == set(result["kinematics"])
    assert "mean ± 1 SD of Schwartz 2008, n = 82, children (ages not stated)" in text
    assert "GDI: not computed, because no published feature basis is loaded" in text


def test_spatiotemporal_values_are_those_of_the_file_s_events(analysed, recordings):
    result, _ = analysed()
    walk = recordings["straight"]
    for side, opposite in (("left", "right"), ("right", "left")):
        own, other = (walk.markers["LHEE" if s == "left" else "RHEE"][:, :2] for s in (side, opposite))
        found = result["spatiotemporal"][side]
        for cycle, values, dimensionless in zip(
            cycles(walk.events, side), found["cycles"], found["normalised_cycles"], strict=True
        ):
            start, end, between = (round(t * walk.rate) for t in (cycle.start, cycle.end, cycle.opposite_foot_strike))
            way, step = own[end] - own[start], own[end] - other[between]
            length = math.hypot(*way)
            duration = cycle.end - cycle.start
            leg = result["subject"]["parameters"][f"{side}_leg_length"]
            expected = {
                "stride_length_m": length,
                "stride_time_s": duration,
                "speed_m_per_s": length / duration,
                "cadence_steps_per_min": 120.0 / duration,
                "step_length_m": float(step @ way) / length,
                "step_width_m": abs(way[0] * step[1] - way[1] * step[0]) / length,
                "step_time_s": cycle.end - cycle.opposite_foot_strike,
                "foot_off_percent": 100.0 * (cycle.foot_off - cycle.start) / duration,
                "opposite_foot_off_percent": 100.0 * (cycle.opposite_foot_off - cycle.start) / duration,
                "opposite_foot_strike_percent": 100.0 * (cycle.opposite_foot_strike - cycle.start) / duration,
            }
            standing, swinging = cycle.foot_off - cycle.start, cycle.opposite_foot_strike - cycle.opposite_foot_off
            expected |= {
                "single_support_percent": 100.0 * swinging / duration,
                "double_support_percent": 100.0 * (standing - swinging) / duration,
                "stance_percent": 100.0 * standing / duration,
                "swing_percent": 100.0 * (duration - standing) / duration,
            }
            assert set(expected) == set(values)
            assert max(abs(values[name] - value) for name, value in expected.items()) < 1e-6
            speed = values["speed_m_per_s"] / math.sqrt(9.81 * leg)
            assert dimensionless["speed"] == pytest.approx(speed, abs=1e-6)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--age", 40), "no norms for this age: Schwartz 2008 holds children (ages not stated), this person is 40"),
        (("--norms", "none"), "no norms: none were asked for"),
        (("--norms", "absent.json"), "no norms: norms absent.json cannot be read"),
        (("--norms", "atlantis"), "norms 'atlantis' does not exist; available: schwartz2008"),
        (("--gdi", "absent.json"), "GDI: not computed: GDI basis absent.json cannot be read"),
    ],
)
def test_what_is_missing_is_said_and_the_report_still_made(analysed, options, words):
    result, text = analysed(*options)
    assert any(words in sentence for sentence in result["scores"]["missing"])
    assert words in text and "Knee flexion" in text


def test_corrupt_norms_are_said_by_name_without_their_folder(analysed, tmp_path):
    (tmp_path / "surname.json").write_text('{"format": "gaitlab-norms-1"}')
    result, text = analysed("--norms", tmp_path / "surname.json")
    assert "no normative band" in text and "surname.json is not a gaitlab reference cohort" in text
    assert result["settings"]["references"]["norms"] == "surname.json" and str(tmp_path) not in text


def test_an_impossible_age_is_refused(gaitlab, files, tmp_path):
    code, _, err = gaitlab("analyse", files / "straight.c3d", "--out", tmp_path, "--no-weights", "--age", -1)
    assert code == 2 and "give a value from 0 to 130 years" in err


def test_one_side_only(gaitlab, reads, recordings, tmp_path, monkeypatch):
    left = tuple(event for event in recordings["straight"].events if event.side == "left")
    monkeypatch.setattr(analyse, "events_to_use", lambda *_: left)
    reads(static=recordings["static"], walk=recordings["straight"])
    arguments = ("analyse", "--static", "static.c3d", "walk.c3d", "--out", tmp_path, "--no-weights")
    assert gaitlab(*arguments)[0] == 0
    scores = json.loads((tmp_path / "result.json").read_text())["scores"]
    assert scores["left"]["gps"] is not None and scores["right"] is None and scores["gps_overall"] is None
    text = Page((tmp_path / "report.html").read_text()).text
    assert "scores of the right side: no complete cycle of it" in text


def test_one_cycle_has_a_score_but_no_spread(analysed):
    result, text = analysed()
    assert all(result["scores"][side]["n_cycles"] == 1 for side in SIDES)
    assert all(result["scores"][side]["gps_sd"] is None for side in SIDES)
    assert "Not shown: consistency. Reason: no side has two complete strides." in text


def test_a_speed_is_matched(analysed):
    result, _ = analysed("--match-speed")
    normalised = [result["spatiotemporal"][side]["normalised"]["speed"] for side in SIDES]
    expected = "fast" if np.mean(normalised) > 0.4946 else "free"
    assert result["scores"]["reference"]["speed_bin"] == expected


def test_norms_of_a_laboratory(gaitlab, analysed, tmp_path):
    for person in ("a", "b"):
        result, _ = analysed("--age", 9 if person == "a" else 11)
        (tmp_path / "people" / person).mkdir(parents=True)
        (tmp_path / "people" / person / "result.json").write_text(json.dumps(result))
    code, out, _ = gaitlab("norms", "build", tmp_path / "people", "--out", tmp_path / "own.json", "--name", "our lab")
    assert code == 0 and "n = 2, 9-11 years" in out
    result, text = analysed("--norms", tmp_path / "own.json", "--age", 10)
    scores = result["scores"]
    assert np.mean([scores[side]["gps"] for side in SIDES]) == pytest.approx(scores["reference"]["gps"]["mean"])
    assert "our lab, n = 2, 9-11 years" in text


def test_a_folder_without_results_makes_no_norms(gaitlab, tmp_path):
    code, _, err = gaitlab("norms", "build", tmp_path, "--out", tmp_path / "own.json")
    assert code == 2 and "holds no folder with a readable result.json" in err


def test_bundled_norms_are_shown(gaitlab):
    code, out, _ = gaitlab("norms", "show")
    assert code == 0 and "Schwartz MH, Rozumalski A, Trost JP" in out and "very fast" in out


def test_what_is_forward_is_a_choice_and_printed(analysed):
    axis, text = analysed()
    assert "measured against the laboratory axis next to the walking direction, as in Plug-in Gait" in text
    along, text = analysed("--along-walk")
    assert "measured against the walking direction." in text and along["settings"]["forward"] == "heading"
    left = [np.array(result["kinematics"]["foot_progression"]["left"]["mean"]) for result in (axis, along)]
    turned = left[0] - left[1]  # this child walks 0.4 deg off the axis
    assert 0.1 < abs(turned.mean()) < 1.0 and turned.std() < abs(turned.mean())
