import numpy as np
import pytest

from gaitlab.signal.gaps import Gap, describe_gaps, fill_gaps

RATE = 100.0


def smooth_track(n: int = 200) -> np.ndarray:
    t = np.arange(n) / RATE
    return np.column_stack([np.sin(2 * np.pi * t), np.cos(2 * np.pi * t), 1.0 + 0.1 * t])


def test_short_gap_is_filled_close_to_the_truth_and_reported():
    truth = smooth_track()
    seen = truth.copy()
    seen[50:58] = np.nan
    filled, report = fill_gaps({"LHEE": seen}, RATE)
    assert filled["LHEE"] == pytest.approx(truth, abs=5e-4)
    assert report == (Gap(marker="LHEE", start=50, end=58, filled=True),)


def test_long_gap_and_missing_ends_stay():
    seen = smooth_track()
    seen[:5] = seen[-5:] = seen[50:90] = np.nan
    filled, report = fill_gaps({"LHEE": seen}, RATE)
    np.testing.assert_array_equal(filled["LHEE"], seen)
    assert report == (Gap(marker="LHEE", start=50, end=90, filled=False),)


def test_nothing_is_made_up_from_a_single_sample():
    seen = smooth_track(20)
    seen[1:4] = np.nan
    filled, report = fill_gaps({"LHEE": seen}, RATE)
    assert np.isnan(filled["LHEE"][1:4]).all()
    assert not report[0].filled


def test_the_callers_array_is_not_changed():
    seen = smooth_track()
    seen[50:52] = np.nan
    fill_gaps({"LHEE": seen}, RATE)
    assert np.isnan(seen[50:52]).all()


def test_description_names_markers_and_what_was_done():
    gaps = (Gap(marker="LHEE", start=0, end=4, filled=True), Gap(marker="C7", start=0, end=90, filled=False))
    assert describe_gaps(gaps, RATE) == (
        "1 gaps filled in LHEE (longest 0.04 s)",
        "1 gaps left open in C7 (longest 0.90 s)",
    )
    assert describe_gaps(gaps, RATE, frozenset({"LHEE"})) == ("1 gaps filled in LHEE (longest 0.04 s)",)
