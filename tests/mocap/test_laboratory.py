import numpy as np
import pytest

from gaitlab.mocap.laboratory import rotation_to_z_up

STANDING = {
    "LHEE": np.array([[0.0, 0.1, 0.05]]),
    "RTOE": np.array([[0.2, -0.1, 0.05]]),
    "SACR": np.array([[0.1, 0, 0.9]]),
}
AXES = {
    "+z": np.eye(3),
    "-z": np.diag([1.0, -1.0, -1.0]),
    "+y": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "-y": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "+x": np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
    "-x": np.array([[0, 0, -1], [0, 1, 0], [1, 0, 0]]),
}


@pytest.mark.parametrize("axis", AXES)
def test_every_vertical_is_found_and_turned(axis):
    rotation, found = rotation_to_z_up({name: x @ AXES[axis].T for name, x in STANDING.items()})
    assert found == axis
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert rotation @ AXES[axis] == pytest.approx(np.eye(3))


def test_without_pelvis_or_feet_nothing_is_turned():
    rotation, found = rotation_to_z_up({"LHEE": np.array([[0.0, 1.0, 0.0]])})
    assert found == "+z"
    assert rotation == pytest.approx(np.eye(3))
