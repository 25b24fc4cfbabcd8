import json

import numpy as np
import pytest

from gaitlab.clinical.document import CURVES
from gaitlab.clinical.normative import (
    age_problem,
    choose_bin,
    describe,
    expected_distances,
    read_cohort,
    write_cohort,
)
from gaitlab.errors import InvalidReference
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


def test_a_band_is_printed_with_source_n_age_and_speed(schwartz):
    words = describe(schwartz, schwartz.bin("free"))
    assert all(part in words for part in ("Schwartz 2008", "n = 82", "4-17 years", "free", "0.43"))


@pytest.mark.parametrize(("speed", "name"), [(0.1, "very slow"), (0.3, "slow"), (0.43, "free"), (2.0, "very fast")])
def test_a_speed_finds_its_bin(schwartz, speed, name):
    assert choose_bin(schwartz, "matched", speed)[0].name == name


def test_an_unknown_speed_is_said(schwartz):
    part, remark = choose_bin(schwartz, "matched", None)
    assert part.name == "free" and "not known" in remark
    assert choose_bin(schwartz, "default", None)[1] == ""


@pytest.mark.parametrize(("age", "fits"), [(None, True), (4.0, True), (17.9, True), (18.0, False), (3.9, False)])
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
