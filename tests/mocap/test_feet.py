from dataclasses import replace

import numpy as np
import pytest
from synthetic_walk import Gait, synthetic_walk

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.feet import foot_motion, walking_speed


@pytest.mark.parametrize("speed", [0.3, 1.2, 2.0])
def test_walking_speed(speed):
    assert walking_speed(synthetic_walk(Gait(speed=speed, heading=1.0))) == pytest.approx(speed, rel=1e-3)


def test_standing_before_the_walk_does_not_slow_it():
    walk = synthetic_walk()
    waiting = {name: np.concatenate([np.tile(x[:1], (200, 1)), x]) for name, x in walk.markers.items()}
    assert walking_speed(replace(walk, markers=waiting)) == pytest.approx(1.2, rel=0.02)


def test_a_hidden_marker_is_replaced_frame_by_frame():
    walk = synthetic_walk()
    hidden = walk.markers["LTOE"].copy()
    hidden[100:200] = np.nan
    with_hallux = {**walk.markers, "LTOE": hidden, "LHLX": walk.markers["LTOE"] + [0.05, 0.0, 0.0]}
    motion = foot_motion(replace(walk, markers=with_hallux), "left", 20.0)
    assert np.isfinite(motion.toe_speed).all()
    assert motion.toe[150] == pytest.approx(walk.markers["LTOE"][150] + [0.05, 0.0, 0.0], abs=5e-3)


def test_no_forefoot_marker():
    walk = synthetic_walk()
    others = {name: x for name, x in walk.markers.items() if name != "RTOE"}
    with pytest.raises(InvalidRecording, match="synthetic: none of the markers RTOE, RHLX"):
        foot_motion(replace(walk, markers=others), "right", 20.0)
