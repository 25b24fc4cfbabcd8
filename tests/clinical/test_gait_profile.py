import math

import numpy as np
import pytest

from gaitlab.clinical.gait_profile import PELVIS, VARIABLES, gait_profile, overall_score


def made_up(seed):
    rng = np.random.default_rng(seed)
    return {name: rng.normal(10.0, 15.0, 101) for name in VARIABLES}


def by_hand(curves, reference):
    """Baker 2009 in plain Python."""
    scores = {}
    for name in VARIABLES:
        squares = [(float(a) - float(b)) ** 2 for a, b in zip(curves[name], reference[name], strict=True)]
        scores[name] = math.sqrt(sum(squares) / len(squares))
    return scores, math.sqrt(sum(s * s for s in scores.values()) / 9.0)


@pytest.mark.parametrize("seed", range(5))
def test_scores_are_those_of_an_independent_implementation(seed):
    reference, left, right = (made_up(10 * seed + k) for k in range(3))
    profiles = []
    for curves in (left, right):
        expected, gps = by_hand(curves, reference)
        profile = gait_profile(curves, reference)
        assert max(abs(profile.gvs[name] - expected[name]) for name in VARIABLES) < 1e-9
        assert abs(profile.gps - gps) < 1e-9
        profiles.append(profile)
    (a, _), (b, _) = by_hand(left, reference), by_hand(right, reference)
    fifteen = [*a.values(), *(b[name] for name in VARIABLES[3:])]
    assert PELVIS == VARIABLES[:3] and len(fifteen) == 15
    assert abs(overall_score(*profiles) - math.sqrt(sum(s * s for s in fifteen) / 15.0)) < 1e-9


def test_the_reference_itself_scores_zero():
    reference = made_up(1)
    assert gait_profile(reference, reference).gps == 0.0


def test_a_missing_curve_leaves_the_others_and_no_total():
    reference, curves = made_up(1), made_up(2)
    curves["hip_rotation"] = np.full(101, np.nan)
    del curves["knee_flexion"]
    profile = gait_profile(curves, reference)
    assert profile.missing == ("hip_rotation", "knee_flexion") and len(profile.gvs) == 7
    assert profile.gps is None and overall_score(profile, gait_profile(reference, reference)) is None
