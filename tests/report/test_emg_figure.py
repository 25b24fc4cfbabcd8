import re

import numpy as np
import pytest

from gaitlab.report.emg_figure import Activity, activity_of, emg_figure
from gaitlab.report.kinematics_figure import NO_NORMS, Norms
from gaitlab.report.result import Curve, Result

LABEL = "Voltage.L Rect"
BURST = np.where((np.arange(101) >= 10) & (np.arange(101) < 30), 1.0, 0.1)


def curve(values):
    return Curve(mean=values, sd=None, n_cycles=1)


def bars(markup):
    """Letter to horizontal start and end of its bars in percent."""
    found = re.findall(r'<rect x="([\d.]+)" y="[\d.]+" width="([\d.]+)"[^>]*data-bar="(\w)"', markup)
    return {
        letter: [
            ((float(x) - 66.0) / 2.45, (float(x) + float(w) - 66.0) / 2.45) for x, w, name in found if name == letter
        ]
        for _, _, letter in found
    }


@pytest.fixture
def activity():
    return Activity(spans={LABEL: {"left": [(0.0, 12.0), (90.0, 100.0)]}}, muscles={LABEL: "rectus_femoris"})


def test_bars_stand_where_the_muscle_is_active(activity):
    drawn = bars(emg_figure({LABEL: {"left": curve(BURST)}}, {}, activity))
    assert np.allclose(drawn["L"], [(0.0, 12.0), (90.0, 100.0)], atol=0.1)
    assert "N" not in drawn


def test_the_cohort_s_bars_follow_the_same_rule(activity):
    norms = Norms(description="Cohort, n = 9", curves={"rectus_femoris": curve(BURST)})
    markup = emg_figure({LABEL: {"left": curve(BURST)}}, {}, activity, norms)
    assert np.allclose(bars(markup)["N"], [(10.0, 30.0)], atol=0.1)
    assert "Cohort, n = 9" in markup and "rectus femoris" in markup


@pytest.mark.parametrize(
    ("activity", "words"),
    [
        (Activity(), "no bars of activity: the result holds none"),
        (Activity(spans={LABEL: {}}), "no bars of a reference cohort"),
    ],
)
def test_missing_bars_are_told(activity, words):
    assert words in emg_figure({LABEL: {"left": curve(BURST)}}, {}, activity, NO_NORMS)


def test_activity_is_read_from_the_document_and_nonsense_left_out():
    emg = {"activity": {LABEL: {"left": [[1, 2], [3], "x", [None, 4]]}}, "muscles": {LABEL: "rectus_femoris"}}
    read = activity_of(Result(name="walk", document={"emg": emg}, events=(), kinematics={}, weights=None))
    assert read.spans == {LABEL: {"left": [(1.0, 2.0)]}} and read.muscles == {LABEL: "rectus_femoris"}
