"""The written URDF, loaded by Pinocchio, is the same mechanism."""

import numpy as np
import pinocchio as pin

from gaitlab.multibody.pinocchio_model import to_pinocchio
from gaitlab.multibody.urdf import to_urdf


def joint_names(subject):
    names = [f"{subject.segments[0].name}_t{axis}" for axis in "xyz"]
    return names + [f"{segment.name}_{axis}" for segment in subject.segments for axis in "yxz"]


def test_loaded_model_has_the_same_inverse_dynamics(random_subject):
    loaded, ours = pin.buildModelFromXML(to_urdf(random_subject)), to_pinocchio(random_subject)
    order = [loaded.joints[loaded.getJointId(name)].idx_v for name in joint_names(random_subject)]
    q, v, a = np.random.default_rng(0).normal(size=(3, random_subject.n_q))
    there = [np.zeros(loaded.nv) for _ in range(3)]
    for vector, value in zip(there, (q, v, a), strict=True):
        vector[order] = value
    expected = pin.rnea(ours, ours.createData(), q, v, a)
    np.testing.assert_allclose(pin.rnea(loaded, loaded.createData(), *there)[order], expected, rtol=1e-9, atol=1e-9)


def test_contact_points_are_frames(random_subject):
    loaded = pin.buildModelFromXML(to_urdf(random_subject))
    assert all(loaded.existFrame(name) for name in random_subject.contacts)
