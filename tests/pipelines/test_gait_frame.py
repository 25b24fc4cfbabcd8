import numpy as np
import pytest

from gaitlab.pipelines.gait_frame import gait_to_lab, lab_to_gait


@pytest.mark.parametrize("heading", [0.0, 0.7, -2.5])
def test_the_walking_direction_is_x_of_the_gait_frame(heading):
    direction = np.array([np.cos(heading), np.sin(heading), 0.0])
    assert lab_to_gait(direction, heading) == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)


def test_there_and_back_is_the_identity():
    points = np.random.default_rng(0).normal(size=(5, 4, 3))
    assert gait_to_lab(lab_to_gait(points, 1.1), 1.1) == pytest.approx(points)
