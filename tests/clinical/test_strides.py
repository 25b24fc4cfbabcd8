import numpy as np
import pytest

from gaitlab.clinical.spatiotemporal import Spatiotemporal
from gaitlab.clinical.strides import consistency, outlier_reasons, representative

CYCLE = np.linspace(0.0, 2.0 * np.pi, 101)


def distances(**values):
    return Spatiotemporal(**(dict.fromkeys(Spatiotemporal.__struct_fields__) | values))


def knees(n, shift=0.5):
    rng = np.random.default_rng(4)
    return [30.0 - 30.0 * np.cos(CYCLE) + shift * rng.normal() for _ in range(n)]


def test_a_stride_unlike_the_others_is_flagged_and_told_why():
    curves = knees(7)
    curves[4] = curves[4] + 15.0
    reasons = outlier_reasons({"knee_flexion": curves}, [distances(speed_m_per_s=1.0)] * 7)
    assert [index for index, found in enumerate(reasons) if found] == [4]
    assert reasons[4][0].startswith("knee flexion is 1")


def test_small_differences_are_no_outliers_however_alike_the_others_are():
    curves = [30.0 - 30.0 * np.cos(CYCLE)] * 6 + [32.0 - 30.0 * np.cos(CYCLE)]
    assert not any(outlier_reasons({"knee_flexion": curves}, [distances()] * 7))


def test_a_slow_stride_is_flagged():
    reasons = outlier_reasons({}, [distances(stride_time_s=t) for t in (1.0, 1.01, 0.99, 1.0, 1.6, 1.02)])
    assert [bool(found) for found in reasons] == [False] * 4 + [True, False]
    assert reasons[4] == ("stride time 1.60 s (median 1.00 s)",)


def test_four_strides_are_too_few_to_judge():
    assert outlier_reasons({}, [distances(stride_time_s=t) for t in (1.0, 1.0, 1.0, 3.0)]) == [()] * 4


def test_the_stride_in_the_middle_is_representative():
    curves = {"knee_flexion": [CYCLE + shift for shift in (3.0, -4.0, 0.1, 1.0, -1.0)]}
    assert representative(curves, [False] * 5) == 2
    assert representative(curves, [False, False, True, False, False]) != 2


def test_incomplete_strides_do_not_represent():
    curves = {"knee_flexion": [np.full(101, np.nan), CYCLE]}
    assert representative(curves, [False, False]) == 1
    assert representative({"knee_flexion": curves["knee_flexion"][:1]}, [False]) is None


def test_equal_strides_are_perfectly_consistent():
    found = consistency([30.0 * np.sin(CYCLE)] * 4)
    assert (found.sd, found.cmc, found.n_strides) == (0.0, 1.0, 4)


def test_consistency_is_spread_and_correlation():
    found = consistency([30.0 * np.sin(CYCLE) + shift for shift in (-2.0, 0.0, 2.0)])
    assert found.sd == pytest.approx(2.0)
    stacked = np.array([30.0 * np.sin(CYCLE) + shift for shift in (-2.0, 0.0, 2.0)])
    total = stacked.var(ddof=1)
    assert found.cmc == pytest.approx(np.sqrt(1.0 - 4.0 / total))


def test_one_stride_has_no_consistency():
    assert consistency([CYCLE, np.full(101, np.nan)]) is None
