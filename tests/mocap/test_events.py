from dataclasses import replace

import numpy as np
import pytest
from event_matching import match_events
from synthetic_walk import Gait, rectangle, synthetic_walk, with_plate

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.events import detect_events, events_of

INSIDE = 0.1  # s from both ends of a trial


def check(recording, true, found, largest=0.045):
    end = (recording.n_frames - 1) / recording.rate - INSIDE
    errors, missed, false = match_events(true, found, INSIDE, end)
    assert (missed, false) == ([], [])
    assert np.abs(errors).max() < largest


@pytest.mark.parametrize("heading", np.radians([0.0, 35.0, 90.0, 180.0, 250.0]))
@pytest.mark.parametrize(
    "gait",
    [
        Gait(),
        Gait(toe_first=True),
        Gait(speed=0.4, stride_time=1.6, stance=0.72),
        Gait(speed=0.5, stride_time=1.2, toe_first=True),
        Gait(speed=1.9, stride_time=0.9, stance=0.58),
    ],
    ids=["usual", "toe first", "slow", "slow toe first", "fast"],
)
def test_known_events_are_found_in_any_direction(gait, heading):
    walk = synthetic_walk(replace(gait, heading=heading))
    check(walk, walk.events, detect_events(walk))


def test_noise_and_short_gaps_do_not_add_events():
    walk = synthetic_walk()
    chance = np.random.default_rng(3)
    noisy = {name: x + 0.001 * chance.standard_normal(x.shape) for name, x in walk.markers.items()}
    for name in ("LHEE", "LTOE", "RHEE", "RTOE"):
        for start in chance.integers(20, 370, size=5):
            noisy[name][start : start + 7] = np.nan
    check(walk, walk.events, detect_events(replace(walk, markers=noisy)))


def test_long_gaps_lose_events_but_invent_none():
    walk = synthetic_walk()
    hidden = {name: x.copy() for name, x in walk.markers.items()}
    hidden["LHEE"][110:150] = np.nan  # around the left strike at 1.25 s
    hidden["RTOE"][240:290] = np.nan  # around the right foot off at 2.48 s
    errors, missed, false = match_events(walk.events, detect_events(replace(walk, markers=hidden)), INSIDE, 3.89)
    assert false == []
    assert sorted((event.side, round(event.time, 2)) for event in missed) == [("left", 1.25), ("right", 2.48)]
    assert np.abs(errors).max() < 0.045


def test_a_hit_plate_decides_the_time():
    walk = synthetic_walk(Gait(origin=(0.0, 0.0)))
    strike = next(e.time for e in walk.events if e.side == "left" and e.kind == "foot_strike" and e.time > 1.0)
    heel = walk.markers["LHEE"][round(strike * walk.rate)]
    corners = rectangle(heel[0] + 0.1, heel[1])
    found = detect_events(with_plate(walk, strike + 0.013, strike + 0.682, corners))
    lefts = [event.time for event in found if event.side == "left" and strike - 0.1 < event.time < strike + 0.8]
    assert lefts == pytest.approx([strike + 0.013, strike + 0.682], abs=1.1e-3)


def test_a_plate_under_nobody_changes_nothing():
    walk = synthetic_walk()
    assert detect_events(with_plate(walk, 1.27, 1.95, rectangle(5.0, 5.0))) == detect_events(walk)


def test_standing_is_no_walk():
    walk = synthetic_walk()
    still = {name: np.tile(x[100], (len(x), 1)) for name, x in walk.markers.items()}
    with pytest.raises(InvalidRecording, match="synthetic: nobody walks in this trial"):
        detect_events(replace(walk, markers=still))


def test_file_events_are_used_when_both_feet_make_a_stride():
    walk = synthetic_walk()
    assert events_of(walk) == walk.events
    assert all(event.source == "detected" for event in events_of(walk, redetect=True))


@pytest.mark.parametrize("kept", [0, 2])
def test_too_few_file_events_are_replaced(kept):
    walk = synthetic_walk()
    found = events_of(replace(walk, events=walk.events[:kept]))
    assert all(event.source == "detected" for event in found)
    check(walk, walk.events, found)


def test_file_events_stay_when_detection_finds_no_more():
    walk = synthetic_walk()
    left = tuple(event for event in walk.events if event.side == "left")
    blind = {name: x for name, x in walk.markers.items() if name[1:] not in ("HEE", "TOE")}
    with pytest.raises(InvalidRecording, match="none of the markers LHEE, LCPG"):
        events_of(replace(walk, events=left, markers=blind))


@pytest.mark.shared_data
def test_hidden_events_of_all_real_walks_are_found(real_recordings):
    """Must hold 2: median error <= 20 ms, 95 % <= 50 ms, missed plus false <= 2 %."""
    standing = ("static", "Static", "BP01", "BP08")
    walks = [r for name, r in real_recordings.items() if r.events and not any(word in name for word in standing)]
    errors: list[float] = []
    missed: list[object] = []
    false: list[object] = []
    for walk in walks:
        end = (walk.n_frames - 1) / walk.rate - INSIDE
        found = match_events(walk.events, detect_events(replace(walk, events=())), INSIDE, end)
        errors.extend(found[0])
        missed.extend(found[1])
        false.extend(found[2])
    assert len(walks) == 14
    assert len(errors) + len(missed) == 151
    assert np.median(np.abs(errors)) <= 0.010
    assert np.percentile(np.abs(errors), 95) <= 0.040
    assert len(missed) + len(false) <= 0.02 * (len(errors) + len(missed))
