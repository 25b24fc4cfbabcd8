from dataclasses import replace

import numpy as np
import pytest
from synthetic_walk import Gait, synthetic_walk

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.cycles import Cycle, cycles, full_strides, visible_strides
from gaitlab.mocap.recording import Event


def event(code: str, time: float) -> Event:
    """'LS' is a left foot strike, 'RO' a right foot off."""
    side = "left" if code[0] == "L" else "right"
    return Event(side=side, kind="foot_strike" if code[1] == "S" else "foot_off", time=time, source="file")


WALK = [event(code, t) for code, t in (("LS", 0.1), ("RO", 0.25), ("RS", 0.6), ("LO", 0.75), ("LS", 1.1), ("RO", 1.25))]


def test_a_cycle_and_the_events_inside_it():
    assert cycles(list(reversed(WALK)), "left") == (
        Cycle(side="left", start=0.1, end=1.1, foot_off=0.75, opposite_foot_off=0.25, opposite_foot_strike=0.6),
    )
    assert cycles(WALK, "left")[0].duration == pytest.approx(1.0)


def test_unknown_events_are_none():
    (cycle,) = cycles([event("RS", 0.0), event("RS", 1.0)], "right")
    assert (cycle.foot_off, cycle.opposite_foot_off, cycle.opposite_foot_strike) == (None, None, None)


@pytest.mark.parametrize(
    "events",
    [
        [event("LS", 0.0), event("LS", 9.0)],
        [event("LS", 0.0), event("LS", 0.1)],
        [event("LS", 0.0), event("LO", 0.6), event("LO", 1.6), event("LS", 2.0)],  # a strike was missed
        [event("LS", 0.0), event("RS", 0.5)],
    ],
)
def test_what_is_no_stride(events):
    assert cycles(events, "left") == ()
    with pytest.raises(InvalidRecording, match=r"walk: the trial holds no full stride .* give a longer walk"):
        full_strides("walk", events)


def test_strides_of_both_sides_in_time_order():
    strides = full_strides("walk", synthetic_walk(Gait(duration=3.0)).events)
    assert [stride.side for stride in strides] == ["left", "right", "left", "right"]


def test_strides_with_hidden_markers_are_left_out():
    walk = synthetic_walk(Gait(duration=3.0))
    hidden = walk.markers["RHEE"].copy()
    hidden[40:100] = np.nan
    strides = full_strides("walk", walk.events)
    usable, warnings = visible_strides(replace(walk, markers={**walk.markers, "RHEE": hidden}), strides)
    assert usable == strides[2:]
    assert len(warnings) == 2
    assert "the left stride at 0.15-1.25 s is incomplete: RHEE missing" in warnings[0]


def test_markers_missing_for_a_whole_stance_of_the_only_stride():
    walk = synthetic_walk(Gait(duration=1.4))
    hidden = walk.markers["LTOE"].copy()
    hidden[15:83] = np.nan
    with pytest.raises(InvalidRecording, match=r"synthetic: markers are missing for too long in every stride .*LTOE"):
        visible_strides(replace(walk, markers={**walk.markers, "LTOE": hidden}), full_strides("synthetic", walk.events))
