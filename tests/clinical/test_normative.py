import json

import numpy as np
import pytest

from gaitlab.clinical.document import CURVES
from gaitlab.clinical.kinetics_document import UNITS
from gaitlab.clinical.muscle_activity import active_spans
from gaitlab.clinical.normative import (
    age_problem,
    choose_bin,
    describe,
    expected_distances,
    read_cohort,
    write_cohort,
)
from gaitlab.errors import InvalidReference
from gaitlab.mocap.emg import MUSCLES
from gaitlab.pipelines.references import bundled_norms


@pytest.fixture(scope="module")
def schwartz():
    return read_cohort(bundled_norms())


def test_the_bundled_norms_hold_nine_curves_at_five_speeds(schwartz):
    assert [part.name for part in schwartz.bins] == ["very slow", "slow", "free", "fast", "very fast"]
    assert all(set(part.curves) == set(CURVES) for part in schwartz.bins)


def test_the_bundled_norms_are_able_bodied(schwartz):
    knee = np.array(schwartz.bin("free").curves["knee_flexion"].mean)
    assert 55.0 < knee.max() < 65.0 and 65 <= int(np.argmax(knee)) <= 75
    assert schwartz.bin("free").spatiotemporal["foot_off_percent"].mean == 59.0


def test_the_bundled_norms_hold_forces_and_muscles_at_every_speed(schwartz):
    for part in schwartz.bins:
        assert set(part.kinetics) <= set(UNITS) and len(part.kinetics) == 10
        assert set(part.emg) == set(MUSCLES)


def test_their_moments_and_powers_have_our_signs(schwartz):
    free = schwartz.bin("free").kinetics
    # Free speed of the addendum: peak plantarflexor moment 1.23 N*m/kg at 48 %, peak ankle power 2.80 W/kg at 54 %.
    ankle, power = (np.array(free[name].mean) for name in ("ankle_plantarflexor_moment", "ankle_power"))
    assert (ankle.max(), ankle.argmax()) == (pytest.approx(1.226, abs=1e-3), 48)
    assert (power.max(), power.argmax()) == (pytest.approx(2.80, abs=1e-2), 54)
    assert np.mean(free["hip_abductor_moment"].mean[10:50]) > 0.3
    assert 100.0 < max(free["ground_reaction_vertical"].mean) < 120.0
    assert np.argmin(free["ground_reaction_forward"].mean) < 20  # braking first


def test_gait_muscles_are_active_when_textbooks_say(schwartz):
    emg = {name: active_spans(np.array(band.mean)) for name, band in schwartz.bin("free").emg.items()}
    # Perry & Burnfield, Gait Analysis, 2010: calf in stance, dorsiflexors in swing, hamstrings around foot strike.
    ((start, end),) = emg["medial_gastrocnemius"]
    assert 0.0 < start < 20.0 and 45.0 < end < 60.0
    for muscle in ("tibialis_anterior", "medial_hamstrings", "lateral_hamstrings"):
        assert emg[muscle][0][0] == 0.0 and emg[muscle][-1][1] == 100.0
    assert 50.0 < emg["tibialis_anterior"][-1][0] < 65.0 and 75.0 < emg["medial_hamstrings"][-1][0] < 90.0


def test_a_band_is_printed_with_source_n_age_and_speed(schwartz):
    words = describe(schwartz, schwartz.bin("free"))
    assert all(part in words for part in ("Schwartz 2008", "n = 82", "children (ages not stated)", "free", "0.43"))


@pytest.mark.parametrize(("speed", "name"), [(0.1, "very slow"), (0.3, "slow"), (0.43, "free"), (2.0, "very fast")])
def test_a_speed_finds_its_bin(schwartz, speed, name):
    assert choose_bin(schwartz, "matched", speed)[0].name == name


def test_an_unknown_speed_is_said(schwartz):
    part, remark = choose_bin(schwartz, "matched", None)
    assert part.name == "free" and "not known" in remark
    assert choose_bin(schwartz, "default", None)[1] == ""


@pytest.mark.parametrize(("age", "fits"), [(None, True), (4.0, True), (17.9, True), (18.0, False)])
def test_ages_outside_the_cohort_are_told(schwartz, age, fits):
    assert (age_problem(schwartz, age) == "") is fits


def test_dimensionless_values_are_multiplied_out(schwartz):
    expected = expected_distances(schwartz.bin("free"), 0.8, 9.81)
    assert expected["speed_m_per_s"].mean == pytest.approx(0.42939 * np.sqrt(9.81 * 0.8))
    assert expected["cadence_steps_per_min"].mean == pytest.approx(60.0 * 0.5648 * np.sqrt(9.81 / 0.8))


def test_what_is_written_can_be_read(schwartz, tmp_path):
    write_cohort(schwartz, tmp_path / "norms.json")
    assert read_cohort(tmp_path / "norms.json") == schwartz


def broken(change):
    document = json.loads(bundled_norms().read_text())
    change(document)
    return json.dumps(document)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.pop("source"), "not a gaitlab reference cohort"),
        (lambda d: d.update(bins=[]), "no speed bin"),
        (lambda d: d.update(default_bin="leisurely"), "no speed bin 'leisurely'"),
        (lambda d: d["bins"][0].update(n=0), "no persons"),
        (lambda d: d["bins"][0]["curves"]["hip_flexion"]["mean"].pop(), "101 samples"),
        (lambda d: d["bins"][0]["curves"]["hip_flexion"]["sd"].__setitem__(3, -1.0), "negative"),
    ],
)
def test_broken_norms_are_refused_with_the_reason(tmp_path, change, words):
    (tmp_path / "norms.json").write_text(broken(change))
    with pytest.raises(InvalidReference, match=words):
        read_cohort(tmp_path / "norms.json")
