"""The result document's weights from an explanation that is made up, so that every number is known."""

from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from gaitlab.bilevel.result import rms
from gaitlab.clinical.document import WeightsEntry
from gaitlab.mocap.cycles import Cycle
from gaitlab.nlp.solution import KKTResiduals
from gaitlab.nlp.sparse_solution import SparseSolution, Status
from gaitlab.pipelines.weights_entry import JOINTS, stride_entry, weights_entry

CRITERIA = ("torque", "lateral_stability", "hip_rotation_torque")
THETA = np.array([0.75, 0.25, 0.0])
NORMALISERS = np.array([10.0, 2.0, 4.0])
VARIANCES = np.array([0.01, 0.04, np.inf])
TERMS = dict(zip(CRITERIA, (3.0, 1.0, 0.0), strict=True)) | {
    "torque_floor": 0.5,
    "smoothness_floor": 0.4,
    "contact_force_floor": 0.1,
}
RESIDUAL = np.repeat(0.01 * np.arange(1, 10), 3) * np.ones((5, 1))
"""Each group of three coordinates is off by its own amount, in all of five instants."""
JACOBIAN = np.random.default_rng(2).normal(size=(RESIDUAL.size, 3))
JACOBIAN -= RESIDUAL.reshape(-1, 1) @ (RESIDUAL.reshape(1, -1) @ JACOBIAN) / np.sum(RESIDUAL**2)
"""No weight moves the optimum towards the measurement: the weights are the best fit."""


class MadeUp:
    """What `weights_entry` reads of an Explanation."""

    def __init__(self, certified=True, minimum=True, states_estimated=False):
        residuals = KKTResiduals(stationarity=2e-9, primal=3e-9, complementarity=1e-7)
        nothing = np.zeros(0)
        solution = SparseSolution(
            w=nothing, s=nothing, lam_g=nothing, lam_c=nothing, f=5.0,
            mu=1e-7, iterations=4, residuals=residuals, status=Status.SOLVED,
        )  # fmt: skip
        self.is_certified, self.tracking_seconds = certified, 3.0
        self.states_estimated = states_estimated
        self.equal_rms, self.single_rms = 0.08, {"torque": 0.09, "lateral_stability": None, "hip_rotation_torque": 0.1}
        self.tracked = SimpleNamespace(
            rms=0.02, solution=SimpleNamespace(iterations=20), stride=SimpleNamespace(times=np.linspace(0.0, 1.0, 46))
        )
        self.level = SimpleNamespace(
            settings=SimpleNamespace(criteria=CRITERIA, torque_floor=0.01, smoothness_floor=0.05),
            longest_arc=0.12,
            normalisers=NORMALISERS,
            given_nodes=np.arange(0, 46, 5),
        )
        self.optimum = SimpleNamespace(
            solution=solution,
            sensitivity=SimpleNamespace(is_minimum=lambda: minimum),
            cost_terms=lambda: dict(TERMS),
            residual_by_time=lambda: RESIDUAL,
        )
        self.estimate = SimpleNamespace(
            theta=THETA,
            covariance=np.diag(VARIANCES),
            identifiable=np.array([True, True, False]),
            rms=rms(RESIDUAL),
            iterations=6,
            lower_iterations=30,
            reason="iteration limit reached",
            response=SimpleNamespace(jacobian=lambda: JACOBIAN, residual_by_time=lambda: RESIDUAL),
        )


@pytest.fixture(scope="module")
def entry():
    return weights_entry(MadeUp(), 12.5)


def test_weights_are_given_normalised_and_raw(entry):
    assert [c.name for c in entry.criteria] == list(CRITERIA)
    assert [c.weight for c in entry.criteria] == pytest.approx(THETA)
    assert [c.raw_weight for c in entry.criteria] == pytest.approx([0.075, 0.125, 0.0])
    assert [c.at_bound for c in entry.criteria] == [False, False, True]


def test_spread_is_left_out_where_it_is_infinite(entry):
    assert [c.sd for c in entry.criteria] == [pytest.approx(0.1), pytest.approx(0.2), None]
    assert [c.identifiable for c in entry.criteria] == [True, True, False]
    assert entry.covariance[2][2] is None
    assert entry.correlation == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]
    assert any("do not tell" in note and "hip_rotation_torque" in note for note in entry.notes)


def test_intervals_hold_the_weights_and_end_at_zero(entry):
    intervals = [c.interval_95 for c in entry.criteria]
    assert all(low <= weight <= high for (low, high), weight in zip(intervals, THETA, strict=True))
    assert intervals[2][0] == 0.0 < intervals[2][1]
    assert entry.not_told_apart == []


def test_with_estimated_states_intervals_come_from_the_covariance():
    found = weights_entry(MadeUp(states_estimated=True), 1.0)
    assert found.criteria[0].interval_95 == pytest.approx([0.75 - 0.196, 0.75 + 0.196], abs=1e-4)
    assert found.criteria[1].interval_95 == pytest.approx([0.0, 0.25 + 0.392], abs=1e-4)
    assert found.criteria[2].interval_95 is None


def test_criteria_that_do_the_same_are_named():
    twins = MadeUp()
    twins.estimate.response.jacobian = lambda: JACOBIAN[:, [0, 0, 2]]
    found = weights_entry(twins, 1.0)
    assert found.not_told_apart == [["torque", "lateral_stability"]]
    assert any("cannot tell torque and lateral_stability apart" in note for note in found.notes)


def test_shares_of_the_cost_add_up_to_one(entry):
    assert [c.cost_share for c in entry.criteria] == pytest.approx([0.6, 0.2, 0.0])
    assert entry.solver.regularisation_share == pytest.approx(0.2)


def test_fit_is_given_per_joint(entry):
    expected = {name: 0.01 * (k + 1) for k, name in enumerate(JOINTS)}
    assert entry.fit.per_joint == pytest.approx(expected)
    assert entry.fit.rms_rad == pytest.approx(rms(np.array(list(expected.values()))))


def test_certificate_is_the_largest_residual(entry):
    assert entry.solver.kkt_residual == 1e-7
    assert entry.solver.status == "solved"
    assert entry.solver.reduced_hessian == "positive definite"
    assert entry.solver.iterations == 6 + 30 + 20
    assert entry.solver.message == ""


def test_what_is_not_certified_says_so():
    solver = weights_entry(MadeUp(certified=False, minimum=False), 1.0).solver
    assert solver.status == "not_converged"
    assert solver.reduced_hessian == "not positive definite"
    assert "iteration limit reached" in solver.message


def test_comparison_tells_what_other_weights_would_have_given(entry):
    assert entry.comparison.equal_weights_rms_rad == 0.08
    assert entry.comparison.single_criterion_rms_rad["lateral_stability"] is None


def test_entry_survives_json(entry):
    assert msgspec.json.decode(msgspec.json.encode(entry), type=WeightsEntry) == entry


def test_short_form_for_the_table_of_strides():
    cycle = Cycle(side="left", start=0.5, end=1.5, foot_off=1.1, opposite_foot_off=0.6, opposite_foot_strike=1.0)
    short = stride_entry("walk1", cycle, MadeUp(), 3.0)
    assert short.weights == pytest.approx(dict(zip(CRITERIA, THETA, strict=True)))
    assert (short.trial, short.side, short.start_s, short.end_s) == ("walk1", "left", 0.5, 1.5)
