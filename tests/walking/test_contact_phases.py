"""Phases of an invented foot; those of real walks are in test_contact_children."""

from itertools import groupby

import numpy as np
import pytest

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.recording import Event, SoleChange
from gaitlab.multibody.subject import PointOnSegment, Segment, SubjectModel
from gaitlab.walking.contact_phases import GaitEvents, contact_phases, foot_directions

RATE, N = 100.0, 100
STRIKE, OFF = 0.2, 0.8


def event(side, kind, time):
    return Event(side=side, kind=kind, time=time, source="detected")


FEET = (
    event("right", "foot_strike", STRIKE),
    event("right", "foot_off", OFF),
    event("left", "foot_off", 0.3),
    event("left", "foot_strike", 0.7),
)
EVENTS = GaitEvents(feet=FEET)


def walker():
    """A pelvis with a foot of 0.2 m on each side; pitch a of a foot lifts its heel by 0.2 sin a over its toe."""

    def segment(name, parent):
        zero = np.zeros(3)
        return Segment(
            name=name, parent=parent, joint_offset=zero, rotation_offset=zero,
            mass=1.0, centre_of_mass=zero, inertia=np.eye(3),
        )  # fmt: skip

    heel, toe = np.array([-0.05, 0.0, 0.0]), np.array([0.15, 0.0, 0.0])
    contacts = {
        f"{side}_{name}": PointOnSegment(segment=k, position=position)
        for k, side in ((1, "right"), (2, "left"))
        for name, position in (("heel", heel), ("toe", toe))
    }
    segments = (segment("pelvis", -1), segment("right_foot", 0), segment("left_foot", 0))
    return SubjectModel(name="walker", segments=segments, contacts=contacts)


def motion(rises, resting=slice(0, 0)):
    """Coordinates with the right heel over its toe by `rises` [m] during stance; the body rests in some frames."""
    q = np.zeros((N, 12))
    q[:, 0] = np.cumsum(np.where(np.isin(np.arange(N), np.arange(N)[resting]), 0.0, 1.0 / RATE))
    q[20:80, 6] = np.arcsin(np.asarray(rises) / 0.2)
    return q


def sequence(phases):
    return [(str(state), len(list(run))) for state, run in groupby(phases)]


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        ([(-0.04, 10), (0.0, 30), (0.05, 20)], [("heel", 10), ("flat", 30), ("toe", 20)]),
        ([(0.04, 15), (0.0, 45)], [("toe", 15), ("flat", 45)]),
        ([(0.05, 60)], [("toe", 60)]),
        ([(0.01, 60)], [("flat", 60)]),
    ],
    ids=["heel first", "toe first", "toe walker", "flat landing"],
)
def test_any_order_of_contact(parts, expected):
    phases = contact_phases(walker(), motion(np.concatenate([np.full(n, h) for h, n in parts])), RATE, EVENTS)
    assert sequence(phases[:, 0]) == [("free", 20), *expected, ("free", 20)]
    assert sequence(phases[:, 1]) == [("flat", 30), ("free", 40), ("flat", 30)]


@pytest.mark.parametrize(("rest", "expected"), [(0.012, "flat"), (0.03, "toe")])
def test_a_small_tilt_at_rest_is_the_flat_level_and_a_large_one_is_a_raised_heel(rest, expected):
    rises = np.full(60, rest + 0.01)
    rises[20:40] = rest
    phases = contact_phases(walker(), motion(rises, resting=slice(40, 60)), RATE, EVENTS)
    assert set(phases[20:80, 0]) == {expected}


def test_unknown_frames_take_what_is_known_around_them():
    q = motion(np.repeat([-0.04, 0.0, 0.05], 20))
    hidden = q.copy()
    hidden[[*range(10, 25), *range(45, 55)]] = np.nan
    np.testing.assert_array_equal(
        contact_phases(walker(), hidden, RATE, EVENTS), contact_phases(walker(), q, RATE, EVENTS)
    )
    hidden[20:80] = np.nan
    assert set(contact_phases(walker(), hidden, RATE, EVENTS)[20:80, 0]) == {"flat"}


@pytest.mark.parametrize(("height", "first"), [(-0.002, "heel"), (0.002, "toe")])
def test_marked_changes_of_the_sole_are_believed_before_heights(height, first):
    marks = (
        SoleChange(side="right", kind="foot_flat", time=0.3),
        SoleChange(side="right", kind="heel_off", time=0.6),
        SoleChange(side="left", kind="heel_off", time=0.25),
    )
    phases = contact_phases(walker(), motion(np.full(60, height)), RATE, GaitEvents(feet=FEET, soles=marks))
    assert sequence(phases[20:80, 0]) == [(first, 10), ("flat", 30), ("toe", 20)]
    assert sequence(phases[:, 1]) == [("flat", 25), ("toe", 5), ("free", 40), ("flat", 30)]


def test_direction_of_turned_feet():
    q = motion(np.zeros(60))
    q[:, 8], q[:, 11] = -0.3, 1.2
    phases = contact_phases(walker(), q, RATE, EVENTS)
    np.testing.assert_allclose(foot_directions(walker(), q, phases), [-0.3, 1.2], atol=1e-12)


def test_a_foot_without_events_is_refused():
    with pytest.raises(InvalidRecording, match="the left foot has no event"):
        contact_phases(walker(), motion(np.zeros(60)), RATE, GaitEvents(feet=FEET[:2]))
