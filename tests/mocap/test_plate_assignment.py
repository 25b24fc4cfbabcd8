from dataclasses import replace

import numpy as np
import pytest
from synthetic_walk import Gait, rectangle, synthetic_walk

from gaitlab.mocap.plate_assignment import assign_contacts, contact_sentences
from gaitlab.mocap.recording import ForcePlate
from gaitlab.signal.runs import runs

WALK = synthetic_walk(Gait(origin=(0.0, 0.0)))
STRIKE, OFF = 1.25, 1.93  # s, of the left foot
HEEL = WALK.markers["LHEE"][round(STRIKE * WALK.rate)]
MIDDLE = HEEL[0] + 0.1
RATE = 1000.0


def pressed(start, end, corners, way=(0.0, 0.2)):
    """The walk with a plate pressed by 300 N between two times [s], at `way` [m] before the heel."""
    t = np.arange(round(RATE * WALK.n_frames / WALK.rate)) / RATE
    on = (t >= start) & (t < end)
    force, moment = np.zeros((len(t), 3)), np.zeros((len(t), 3))
    force[on, 2] = 300.0
    lever = np.zeros((len(t), 3))
    lever[:, 0] = HEEL[0] + np.interp(t, [start, end], way)
    lever[:, 1] = HEEL[1]
    lever -= corners.mean(axis=0) * [1.0, 1.0, 0.0]
    moment[on] = np.cross(lever, force)[on]
    plate = ForcePlate(corners=corners, force=force, moment=moment, rate=RATE)
    return replace(WALK, force_plates=(*WALK.force_plates, plate))


def only(walk):
    (contact,) = assign_contacts(walk, walk.events)
    return contact


def test_a_foot_that_stands_inside_is_accepted():
    contact = only(pressed(STRIKE, OFF, rectangle(MIDDLE, HEEL[1])))
    assert (contact.plate, contact.side, contact.reason) == (0, "left", "")
    assert (contact.start, contact.end) == pytest.approx((STRIKE, OFF), abs=2e-3)


def test_a_foot_that_stands_partly_beside_is_rejected():
    contact = only(pressed(STRIKE, OFF, rectangle(MIDDLE - 0.2, HEEL[1])))
    assert contact.side == "left" and "partly beside" in contact.reason


def test_a_plate_that_two_feet_use_is_rejected():
    contact = only(pressed(STRIKE, OFF, rectangle(MIDDLE, 0.0, length=2.4, width=0.6)))
    assert contact.reason == "the right foot stood on it too"


def test_a_plate_that_no_foot_uses_is_rejected():
    contact = only(pressed(STRIKE, OFF, rectangle(MIDDLE + 5.0, 1.0), way=(5.0, 5.0)))
    assert contact.side is None and "no foot" in contact.reason


def test_a_pressure_that_leaves_the_foot_is_rejected():
    contact = only(pressed(STRIKE, OFF, rectangle(MIDDLE + 0.1, HEEL[1], length=0.7), way=(0.0, 0.4)))
    assert "centre of pressure leaves the foot" in contact.reason


def test_a_stance_longer_than_the_load_is_rejected():
    contact = only(pressed(STRIKE, OFF - 0.3, rectangle(MIDDLE, HEEL[1])))
    assert "stood longer" in contact.reason


def test_toes_may_overhang_a_step():
    lower = ForcePlate(
        corners=rectangle(9.0, 9.0, z=-0.3), force=np.zeros((10, 3)), moment=np.zeros((10, 3)), rate=RATE
    )
    flat = pressed(STRIKE, OFF, rectangle(MIDDLE - 0.2, HEEL[1]))
    stairs = replace(flat, force_plates=(*flat.force_plates, lower))
    assert only(flat).reason and not only(stairs).reason


def test_a_foot_that_lets_go_for_a_moment_makes_one_contact():
    walk = pressed(STRIKE, OFF, rectangle(MIDDLE, HEEL[1]))
    (plate,) = walk.force_plates
    plate.force[1500:1540] = 0.0
    plate.moment[1500:1540] = 0.0
    assert (only(walk).side, only(walk).reason) == ("left", "")


def test_no_plate_no_contact():
    assert assign_contacts(WALK, WALK.events) == ()


def test_reasons_are_said_with_plate_time_and_foot():
    walk = pressed(STRIKE, OFF, rectangle(MIDDLE - 0.2, HEEL[1]))
    (sentence,) = contact_sentences(assign_contacts(walk, walk.events), "walk")
    assert sentence.startswith("walk: force plate 1, 1.25-1.93 s, left foot: not used, the foot stood partly beside it")


STRAIGHT = ["straight_HC002D06", "straight_HC030A05", "straight_HC032A03", "straight_HC033A10"]
STRAIGHT += ["straight_HC040A14", "straight_HC050A11", "MH0222_BP06", "MH0222_BP15"]


@pytest.mark.shared_data
@pytest.mark.parametrize("name", STRAIGHT)
def test_contacts_are_those_of_the_file(real_recordings, name):
    walk = real_recordings[f"{name}.c3d"]
    found = assign_contacts(walk, walk.events)
    for side in ("left", "right"):
        theirs = walk.model_outputs[f"{side[0].upper()}GroundReactionForce"][:, 2]
        loaded = runs(np.nan_to_num(theirs) > 0.0)
        ours = [(c.start * walk.rate, c.end * walk.rate) for c in found if c.accepted and c.side == side]
        assert len(ours) == len(loaded)
        assert np.array(ours) == pytest.approx(np.array(loaded), abs=4.0)


@pytest.mark.shared_data
def test_each_foot_on_a_stair_has_its_step(real_recordings):
    walk = real_recordings["Movement_trial.c3d"]
    found = assign_contacts(walk, ())
    assert [(c.plate, c.side, c.reason) for c in found] == [
        (3, "right", ""),
        (2, "left", ""),
        (1, "right", ""),
        (0, "left", ""),
    ]


@pytest.mark.shared_data
def test_the_double_contact_of_a_real_walk_is_rejected(real_recordings):
    walk = real_recordings["walk.c3d"]
    assert [c.reason for c in assign_contacts(walk, walk.events)] == ["", "", "the left foot stood on it too"]


@pytest.mark.shared_data
def test_the_partial_hit_of_a_real_turn_is_rejected(real_recordings):
    walk = real_recordings["turn_HC032A18.c3d"]
    right, left = assign_contacts(walk, walk.events)
    assert right.accepted and "partly beside" in left.reason
