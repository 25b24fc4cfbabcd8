"""Landing by an impact: speeds before, rest after, and the balance of momentum by Pinocchio."""

import numpy as np
import pinocchio as pin
import pytest
from demo_stride import demo_stride

from gaitlab.multibody.dynamics import GRAVITY
from gaitlab.multibody.pinocchio_model import to_pinocchio
from gaitlab.nlp.sparse_solution import Status
from gaitlab.walking.model import POINTS, ROOT
from gaitlab.walking.tracking import track

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def walk():
    return track(demo_stride(landing="impact"))


@pytest.fixture(scope="module")
def impacts(walk):
    """First node and components that land, of each impact."""
    stages = walk.stride.stages
    starts = np.cumsum([0, *(stage.n_intervals for stage in stages)])
    return [(int(k), stage) for k, stage in zip(starts[:-1], stages, strict=True) if "impact" in stage.label]


def contact_jacobian(subject, q):
    model = to_pinocchio(subject)
    data = model.createData()
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    frames = [model.getFrameId(name) for name in POINTS]
    return np.vstack([pin.getFrameJacobian(model, data, f, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)[:3] for f in frames])


def test_the_walk_is_tracked(walk, impacts):
    assert walk.solution.status is Status.SOLVED
    assert walk.rms <= 0.03
    assert len(impacts) >= 2


def test_feet_touch_with_speed_and_rest_afterwards(walk, impacts):
    n_q, subject = walk.stride.n_q, walk.stride.subject
    speeds = []
    for node, stage in impacts:
        before, after = (
            contact_jacobian(subject, x[:n_q])[list(stage.active)] @ x[n_q:] for x in walk.states[node : node + 2]
        )
        speeds.append(np.abs(before).max())
        np.testing.assert_allclose(after, 0.0, atol=1e-6)
    assert max(speeds) > 0.05


def test_the_impulse_of_the_floor_changes_the_momentum(walk, impacts):
    """M dv = J' Lambda - dt n(q, v) in the six coordinates that nothing actuates."""
    n_q, subject = walk.stride.n_q, walk.stride.subject
    model = to_pinocchio(subject)
    data = model.createData()
    points = walk.problem.points(walk.solution.w)
    for node, stage in impacts:
        (q0, v0), (_, v1) = (np.split(x, 2) for x in walk.states[node : node + 2])
        forces = points[2 * node : 2 * node + 2, 3 * n_q :].mean(axis=0) * subject.mass * GRAVITY
        mass = pin.crba(model, data, q0)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = stage.duration * pin.nonLinearEffects(model, data, q0, 0.5 * (v0 + v1))
        impulse = stage.duration * contact_jacobian(subject, q0).T @ forces
        balance = mass @ (v1 - v0) + bias - impulse
        assert np.abs(balance[:ROOT]).max() <= 0.03 * np.abs(impulse[:ROOT]).max()
