"""Batched kinematics against Pinocchio."""

import numpy as np
import pinocchio as pin
import pytest

from gaitlab.multibody.kinematics import (
    coordinates_from_poses,
    euler_angles,
    forward_kinematics,
    point_positions,
    rotation_matrices,
    unwrapped,
)
from gaitlab.multibody.pinocchio_model import to_pinocchio


@pytest.fixture
def q(random_subject):
    return 0.4 * np.random.default_rng(3).normal(size=(6, random_subject.n_q))


def test_poses_and_points(random_subject, q):
    model = to_pinocchio(random_subject)
    data = model.createData()
    poses, points = forward_kinematics(random_subject, q), point_positions(random_subject, random_subject.contacts, q)
    for k, row in enumerate(q):
        pin.framesForwardKinematics(model, data, row)
        for s in range(len(random_subject.segments)):
            np.testing.assert_allclose(poses.origins[k, s], data.oMi[s + 1].translation, atol=1e-12)
            np.testing.assert_allclose(poses.rotations[k, s], data.oMi[s + 1].rotation, atol=1e-12)
        for name, positions in points.items():
            np.testing.assert_allclose(positions[k], data.oMf[model.getFrameId(name)].translation, atol=1e-12)


def test_coordinates_from_poses_inverts_forward_kinematics(random_subject, q):
    poses = forward_kinematics(random_subject, q)
    again = coordinates_from_poses(random_subject, q[:, :3] + random_subject.segments[0].joint_offset, poses.rotations)
    recovered = forward_kinematics(random_subject, again)
    np.testing.assert_allclose(recovered.origins, poses.origins, atol=1e-12)
    np.testing.assert_allclose(recovered.rotations, poses.rotations, atol=1e-12)


def test_euler_angles_invert_rotations():
    angles = np.random.default_rng(0).uniform([-3, -1.5, -3], [3, 1.5, 3], size=(50, 3))
    np.testing.assert_allclose(euler_angles(rotation_matrices(angles)), angles, atol=1e-12)


def test_unwrapping_bridges_gaps_and_stays_near_zero():
    smooth = np.linspace(-0.5, 5.0, 40)
    wrapped = (smooth + np.pi) % (2 * np.pi) - np.pi
    wrapped[10:13] = np.nan
    result = unwrapped(wrapped[:, None] + 2 * np.pi)[:, 0]
    known = np.isfinite(wrapped)
    np.testing.assert_allclose(result[known], smooth[known], atol=1e-12)
    assert np.isnan(result[10:13]).all()
