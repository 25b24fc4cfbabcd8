import numpy as np
import pytest

from gaitlab.viewer.playback import Playback, frame_at, playback_of


def playback(**changes):
    return Playback(**{"start": 1.0, "end": 3.0, "time": 1.5, "playing": True} | changes)


@pytest.mark.parametrize(("elapsed", "speed", "expected"), [(0.5, 1.0, 2.0), (0.5, 0.1, 1.55), (2.0, 1.0, 1.5)])
def test_time_goes_on_and_starts_again(elapsed, speed, expected):
    assert playback(speed=speed).advanced(elapsed).time == pytest.approx(expected)


def test_a_stopped_playback_stays():
    assert playback(playing=False).advanced(1.0) == playback(playing=False)


def test_a_single_frame_does_not_move():
    assert playback_of(np.array([0.2])).advanced(1.0).time == 0.2


@pytest.mark.parametrize(("moment", "expected"), [(0.0, 1.0), (2.5, 2.5), (9.0, 3.0)])
def test_scrubbing_stays_inside(moment, expected):
    assert playback().moved_to(moment).time == expected


@pytest.mark.parametrize(("moment", "frame"), [(-1.0, 0), (0.014, 1), (0.016, 2), (9.0, 3)])
def test_the_nearest_frame_is_shown(moment, frame):
    assert frame_at(np.array([0.0, 0.01, 0.02, 0.03]), moment) == frame


def test_one_frame_is_always_the_nearest():
    assert frame_at(np.array([0.5]), 7.0) == 0
