import pytest

from gaitlab.clinical.document import Comparison, CriterionWeight, Fit, Solver, StrideWeights, WeightsEntry
from gaitlab.pipelines.pooling import combine_entries, pool_strides


def stride(first, trial="walk"):
    return StrideWeights(trial=trial, side="left", start_s=0.0, end_s=1.0, weights={"a": first, "b": 1.0 - first})


def entry(first, sd=0.01, status="solved", rms=0.03):
    criteria = [
        CriterionWeight(name=name, weight=weight, sd=sd, identifiable=True)
        for name, weight in (("a", first), ("b", 1.0 - first))
    ]
    return WeightsEntry(
        criteria=criteria,
        fit=Fit(rms_rad=rms, per_joint={"knee": rms}),
        solver=Solver(status=status, kkt_residual=1e-9, iterations=5, seconds=2.0, tracking_seconds=3.0),
        comparison=Comparison(equal_weights_rms_rad=0.05, single_criterion_rms_rad={"a": 0.06, "b": None}),
        strides=[stride(first)],
    )


def test_one_stride_has_no_spread():
    pooled = pool_strides([stride(0.3)])
    assert pooled.weights == pytest.approx({"a": 0.3, "b": 0.7})
    assert pooled.between_stride_sd == {"a": None, "b": None}


def test_spread_is_the_sample_standard_deviation():
    pooled = pool_strides([stride(0.2), stride(0.4)])
    assert pooled.weights["a"] == pytest.approx(0.3)
    assert pooled.between_stride_sd["a"] == pytest.approx(0.2 / 2**0.5)


def test_three_strides_are_enough_for_a_bootstrap():
    values = (0.2, 0.3, 0.4)
    low, high = pool_strides([stride(value) for value in values]).bootstrap_95["a"]
    assert low == pytest.approx(0.2)
    assert high == pytest.approx(0.4)
    assert pool_strides([stride(0.2), stride(0.4)]).bootstrap_95 == {}


def test_the_larger_of_both_variances_counts():
    apart, alike = combine_entries([entry(0.2), entry(0.4)]), combine_entries([entry(0.3), entry(0.3)])
    assert apart.criteria[0].sd == pytest.approx(0.1)
    assert alike.criteria[0].sd == pytest.approx(0.01 / 2**0.5)


def test_weights_of_several_trials_sum_to_one():
    assert sum(c.weight for c in combine_entries([entry(0.1), entry(0.6), entry(0.8)]).criteria) == pytest.approx(1.0)


def test_one_failure_marks_the_whole():
    combined = combine_entries([entry(0.2), entry(0.3, status="not_converged")])
    assert combined.solver.status == "not_converged"
    assert combined.solver.iterations == 10
    assert combined.solver.tracking_seconds == 6.0
    assert combined.solver.regularisation_share is None


def test_fits_are_pooled_as_root_mean_squares():
    combined = combine_entries([entry(0.2, rms=0.03), entry(0.3, rms=0.04)])
    assert combined.fit.rms_rad == pytest.approx((0.5 * (0.03**2 + 0.04**2)) ** 0.5)
    assert combined.comparison.single_criterion_rms_rad == {"a": pytest.approx(0.06), "b": None}
