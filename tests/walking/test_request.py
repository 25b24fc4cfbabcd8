"""What may be asked of a prediction, and what is refused."""

import numpy as np
import pytest
from identified_demo import identified_demo

from gaitlab.errors import GaitlabError
from gaitlab.multibody.body_change import segment_length
from gaitlab.walking.quantities import QUANTITIES, Present
from gaitlab.walking.request import parse_request


@pytest.fixture(scope="module")
def present():
    return Present(identified_demo())


def test_nothing_asked_changes_nothing(present):
    before, after = (parse_request([], present).situation(share) for share in (0.0, 1.0))
    assert np.array_equal(before.parameters(), after.parameters())
    assert before.task == after.task
    assert before.task.speed == pytest.approx(present.speed)


UNEXPLAINED = ("mechanical_power_weight", "peak_joint_moment_weight")
"""Weights of criteria that the demo gait was explained without."""


@pytest.mark.parametrize("name", [name for name in QUANTITIES if name not in UNEXPLAINED])
def test_every_quantity_can_be_set_and_begins_at_the_identified_gait(present, name):
    quantity = QUANTITIES[name]
    now = present.value(quantity)
    value = now + {"torsion": 5.0, "orthosis": 1.0}.get(quantity.kind, -0.02 * abs(now) - 1e-3)
    if quantity.kind in ("lowest angle", "torque"):
        value = abs(now) + 1.0
    assert value != now
    start = parse_request([f"{name}={value}"], present).situation(0.0)
    assert np.allclose(start.parameters(), present.gait.problem.data.p)
    q, (low, high) = present.states[:, : present.subject.n_q], start.ranges()
    assert np.all(q > low)
    assert np.all(q < high)


def test_values_are_reached(present):
    request = parse_request(["speed=+20%", "left_shank_length=+10%", "mass=-5%"], present)
    end = request.situation(1.0)
    assert end.task.speed == pytest.approx(1.2 * present.speed)
    shank = segment_length(present.subject, "left_shank")
    assert segment_length(end.subject, "left_shank") == pytest.approx(1.1 * shank)
    assert end.subject.mass == pytest.approx(0.95 * present.subject.mass)


def test_two_of_speed_step_length_and_cadence_determine_the_third(present):
    task = parse_request(["cadence=100", "step_length=0.5"], present).situation(1.0).task
    assert task.fixed_time() == pytest.approx(1.2)
    assert task.length(1.2) == pytest.approx(1.0)
    assert not task.frees_time


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (["happiness=1"], "available"),
        (["speed"], "name=value"),
        (["speed=fast"], "number"),
        (["speed=0"], "from 0.05"),
        (["speed=nan"], "from 0.05"),
        (["speed=20%"], "sign"),
        (["left_tibial_torsion=+10%"], "percentage"),
        (["left_shank_length=0"], "from"),
        (["left_shank_length=3"], "from"),
        (["mass=-90%"], "from"),
        (["speed=1", "speed=1.1"], "twice"),
        (["speed=1", "cadence=100", "step_length=0.6"], "two of them"),
        (["left_knee_flexion_min=40", "left_knee_flexion_max=20"], "not below"),
        (["left_knee_extensor_limit=-5"], "from 0"),
        (["torque_weight=1.2"], "from 0 to 1"),
        (["torque_weight=0.7", "lateral_stability_weight=0.4"], "add up to one"),
        (["mechanical_power_weight=0.1"], "criterion of the identified gait"),
        (
            [
                f"{name}_weight=0.2"
                for name in ("lateral_stability", "torque", "hip_adduction_torque", "hip_rotation_torque")
            ],
            "add up to one",
        ),
    ],
)
def test_wrong_requests_are_refused_in_words(present, texts, words):
    with pytest.raises(GaitlabError, match=words):
        parse_request(texts, present)


def test_weights_that_are_not_given_keep_their_proportions(present):
    """From a quarter each."""
    request = parse_request(["torque_weight=0.4", "lateral_stability_weight=0"], present)
    assert np.allclose(request.situation(0.0).weights, 0.25)
    assert np.allclose(request.situation(0.5).weights, [0.125, 0.325, 0.275, 0.275])
    assert np.allclose(request.situation(1.0).weights, [0.0, 0.4, 0.3, 0.3])


def test_one_weight_of_one_leaves_nothing_to_the_others(present):
    assert np.allclose(parse_request(["torque_weight=1"], present).situation(1.0).weights, [0.0, 1.0, 0.0, 0.0])


def test_raw_weights_move_by_the_normalised_change(present):
    gait = present.gait
    assert np.array_equal(gait.raw_weights(gait.weights), gait.raw_weights())
    moved = gait.raw_weights(np.array([0.5, 0.5, 0.0, 0.0])) - gait.raw_weights()
    assert np.allclose(moved[:4] * gait.normalisers, [0.25, 0.25, -0.25, -0.25])
