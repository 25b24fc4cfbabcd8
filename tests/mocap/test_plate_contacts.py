import numpy as np
import pytest
from synthetic_walk import Gait, rectangle, synthetic_walk, with_plate

from gaitlab.mocap.feet import foot_motion
from gaitlab.mocap.plate_contacts import contacts, plate_edges
from gaitlab.mocap.recording import ForcePlate

WALK = synthetic_walk(Gait(origin=(0.0, 0.0)))
MOTIONS = [foot_motion(WALK, side, 20.0) for side in ("left", "right")]
STRIKE = 1.25  # s, left
HEEL = WALK.markers["LHEE"][round(STRIKE * WALK.rate)]


def edges(start: float, end: float, corners: np.ndarray):
    return plate_edges(with_plate(WALK, start, end, corners), MOTIONS)


def test_a_foot_on_the_plate_makes_both_edges():
    strike, off = edges(1.25, 1.93, rectangle(HEEL[0] + 0.1, HEEL[1]))
    assert (strike.kind, strike.time, strike.sides) == ("foot_strike", pytest.approx(1.25), {"left"})
    assert (off.kind, off.time, off.sides) == ("foot_off", pytest.approx(1.93), {"left"})


def test_a_heel_before_the_plate_does_not_date_the_strike():
    strike, off = edges(1.35, 1.93, rectangle(HEEL[0] + 0.35, HEEL[1], length=0.5))
    assert (strike.sides, off.sides) == (frozenset(), {"left"})


def test_a_toe_beyond_the_plate_does_not_date_the_foot_off():
    strike, off = edges(1.25, 1.7, rectangle(HEEL[0] - 0.15, HEEL[1], length=0.5))
    assert (strike.sides, off.sides) == ({"left"}, frozenset())


def test_a_plate_on_another_step_of_a_stair_is_not_meant():
    assert edges(1.25, 1.93, rectangle(HEEL[0] + 0.1, HEEL[1], z=-0.4))[0].sides == frozenset()


def test_a_contact_cut_by_the_end_has_one_edge():
    assert [edge.kind for edge in edges(0.5, 99.0, rectangle(0.0, 0.0))] == ["foot_strike"]


def test_noise_and_short_interruptions():
    force = np.zeros((1000, 3))
    force[::7, 2] = 30.0  # noise above the threshold
    force[200:500, 2] = 400.0
    force[300:310, 2] = 0.0  # 10 ms
    plate = ForcePlate(corners=rectangle(0, 0), force=force, moment=force, rate=1000.0)
    ((start, end),) = contacts(plate)
    assert start in (200, 199)
    assert end in (500, 501)
