"""Every number of the report that needs a convention has it printed beside it."""

import pytest
from synthetic_output import document, write_output

from gaitlab.clinical.kinetics_document import UNITS
from gaitlab.report.blocks import Paragraph
from gaitlab.report.clinical_sections import kinematics_section, spatiotemporal_section
from gaitlab.report.kinetics_sections import emg_sections, kinetics_sections
from gaitlab.report.result import read_result


def average(value):
    return {"mean": [value] * 101, "sd": [None] * 101, "n_cycles": 1}


@pytest.fixture
def result(tmp_path):
    curves = {name: {"unit": unit, "left": average(0.5)} for name, unit in UNITS.items()}
    kinetics = {"curves": curves, "moments_in": "the joint coordinate system", "inertia": "the subject's model"}
    emg = {"envelopes": {"L Rect": {"unit": "V", "left": average(0.1)}}, "filter": "band-pass 20-450 Hz"}
    emg |= {"activity": {"L Rect": {"left": [[0, 12]]}}, "activity_rule": "bars: the rule", "muscles": {}}
    settings = {"forward": "heading"}
    written = document() | {"kinetics": kinetics, "emg": emg, "settings": settings}
    return read_result(write_output(tmp_path, written))


def words(section):
    return " ".join(block.words for block in section.blocks if isinstance(block, Paragraph))


def test_angles(result):
    said = words(kinematics_section(result))
    assert "knee flexion +" in said and "measured against the walking direction." in said


def test_an_older_result_does_not_claim_a_direction(tmp_path):
    old = read_result(write_output(tmp_path, document()))
    assert "measured against a direction that the result does not state" in words(kinematics_section(old))


def test_distances_and_times(result):
    said = words(spatiotemporal_section(result))
    assert all(part in said for part in ("step width: distance", "way of the heel marker", "sum of both phases"))


def test_moments_powers_and_reactions(result):
    said = words(kinetics_sections(result)[0])
    assert "moments are internal" in said and "expressed in the joint coordinate system" in said
    assert "power is positive when muscles generate it" in said and "medial is towards the other foot" in said


def test_muscles(result):
    said = words(emg_sections(result)[0])
    assert "band-pass 20-450 Hz" in said and "Activity bars: the rule." in said
