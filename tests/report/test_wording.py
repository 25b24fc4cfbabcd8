import numpy as np
import pytest

from gaitlab.report.result import Criterion, Result, Weights
from gaitlab.report.wording import cohort_weights, weights_in_words


def criterion(name, weight, sd, identifiable=True, at_bound=False):
    return Criterion(
        name=name, weight=weight, sd=sd, identifiable=identifiable, raw=None, share=None, at_bound=at_bound
    )


def words(*criteria, reference=None, **others):
    return " ".join(weights_in_words(weights(criteria, **others), reference))


def weights(criteria, correlation=None, fit=None, comparison=None, status="solved"):
    return Weights(
        criteria=criteria,
        correlation=correlation,
        fit_rms=fit,
        per_joint={},
        comparison=comparison or {},
        solver={"status": status},
        document={},
    )


@pytest.mark.parametrize(
    ("sd", "expected"), [(0.05, "more than two standard deviations"), (0.2, "is not established by this recording")]
)
def test_an_order_is_claimed_only_beyond_two_standard_deviations(sd, expected):
    assert expected in words(criterion("a", 0.6, sd), criterion("b", 0.4, 0.0))


def test_correlation_counts_in_the_difference():
    # s^2 = 0.08^2 + 0.08^2 - 2 r 0.08^2: 0.226 = 2 s without correlation, 0.32 with r = -1.
    criteria = criterion("a", 0.64, 0.08), criterion("b", 0.36, 0.08)
    assert "more than two" in words(*criteria)
    assert "not established" in words(*criteria, correlation=np.array([[1.0, -1.0], [-1.0, 1.0]]))


def test_what_is_not_identifiable_is_not_ranked():
    said = words(criterion("a", 0.2, 0.01), criterion("peak_moment", 0.8, None, identifiable=False))
    assert "Not identifiable from this recording: peak moment" in said
    assert "peak moment 80 %" not in said


def test_a_weight_at_its_bound_is_told():
    assert "Zero because a weight cannot be negative: b." in words(
        criterion("a", 1.0, 0.1), criterion("b", 0.0, None, at_bound=True)
    )


def test_a_worse_fit_than_another_is_not_hidden():
    said = words(criterion("a", 1.0, 0.1), fit=0.05, comparison={"equal weights": 0.04, "only a": 0.06})
    assert "These weights are no better than: equal weights." in said


def test_nothing_is_concluded_without_a_certificate():
    said = words(criterion("a", 1.0, 0.1), status="not_converged")
    assert said.startswith("The computation did not reach its certificate (status: not converged).")
    assert "100 %" not in said


def test_shares_stand_beside_the_reference_cohort():
    said = words(criterion("stability", 0.62, 0.05), reference={"stability": (0.325, 0.125)})
    assert said.startswith("Shares of the modelled cost: stability 62 % (sd 5 %; reference cohort 20-45 %).")


def test_without_a_cohort_the_reader_is_told():
    assert "No reference cohort for weights" in words(criterion("a", 1.0, 0.1))


@pytest.mark.parametrize(("names", "expected"), [(("a", "b"), {"a": (0.3, 0.1), "b": (0.3, 0.1)}), (("a",), {})])
def test_a_cohort_counts_only_with_the_same_criteria(names, expected):
    stored = {name: {"mean": 0.3, "sd": 0.1} for name in names}
    result = Result(
        name="x",
        document={"scores": {"reference": {"weights": stored}}},
        events=(),
        kinematics={},
        weights=weights((criterion("a", 0.5, 0.1), criterion("b", 0.5, 0.1))),
    )
    assert cohort_weights(result) == expected
