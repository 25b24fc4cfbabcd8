"""The gait model against Pinocchio, expressions evaluated directly."""

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from gaitlab.multibody.dynamics import GRAVITY, layout_of, parameter_vector
from gaitlab.multibody.pinocchio_model import to_pinocchio
from gaitlab.multibody.presets import thesis_able_bodied_child, thesis_cp_child
from gaitlab.walking.criteria import ALL
from gaitlab.walking.model import LEFT_THIGH, POINTS, RIGHT_THIGH, ROOT, walking_model

CHILDREN = {"cp": thesis_cp_child, "able-bodied": thesis_able_bodied_child}


class Walker:
    """The model of one child, at random states, with and without ligaments."""

    def __init__(self, subject):
        self.subject, self.layout = subject, layout_of(subject)
        self.weight = GRAVITY * sum(segment.mass for segment in subject.segments)
        m = self.symbols = walking_model(self.layout)
        self.outputs = ca.Function("y", [m.q, m.v, m.a, m.f, m.p], [m.outputs])
        self.contacts = ca.Function("c", [m.q, m.v, m.p], [m.positions, m.velocities])
        self.criteria = ca.Function("phi", [m.y, m.v, m.p, m.d], [m.criteria])
        self.pinocchio = to_pinocchio(subject)
        self.data = self.pinocchio.createData()

    def parameters(self, stiffness=0.0, damping=0.0, neutral=0.0):
        passive = [np.full(self.layout.n_q - ROOT, number) for number in (stiffness, damping, neutral)]
        return np.concatenate([parameter_vector(self.subject), *passive])

    def evaluate(self, state, **passive):
        return self.outputs(*state, self.parameters(**passive)).full().ravel()

    def frames(self, q):
        """World position and Jacobian of every contact point, in the order of the forces."""
        pin.computeJointJacobians(self.pinocchio, self.data, q)
        pin.updateFramePlacements(self.pinocchio, self.data)
        ids = [self.pinocchio.getFrameId(name) for name in POINTS]
        world = pin.LOCAL_WORLD_ALIGNED
        jacobians = [pin.getFrameJacobian(self.pinocchio, self.data, i, world)[:3] for i in ids]
        return np.array([self.data.oMf[i].translation for i in ids]), np.vstack(jacobians)


@pytest.fixture(scope="module", params=CHILDREN)
def walker(request):
    return Walker(CHILDREN[request.param]())


@pytest.fixture(params=range(3))
def state(request, walker):
    """q, v, a and forces in body weights."""
    generator = np.random.default_rng(request.param)
    q, v, a = generator.normal(scale=0.5, size=(3, walker.layout.n_q))
    return q, v, a, generator.normal(size=12)


def test_torques_and_root_residual(walker, state):
    q, v, a, f = state
    expected = pin.rnea(walker.pinocchio, walker.data, q, v, a) - walker.frames(q)[1].T @ (walker.weight * f)
    found = walker.evaluate(state)
    assert walker.symbols.n_residual == ROOT == 6
    np.testing.assert_allclose(walker.weight * found[:6], expected[:6], rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(found[6:24], expected[6:], rtol=1e-9, atol=1e-8)


def test_ligaments_relieve_the_muscles(walker, state):
    """tau_muscle = tau - tau_passive with tau_passive = - k (q - q0) - c v, at joints only."""
    q, v, _, _ = state
    difference = walker.evaluate(state, stiffness=5.0, damping=0.7, neutral=0.2) - walker.evaluate(state)
    np.testing.assert_allclose(difference[6:24], 5.0 * (q[6:] - 0.2) + 0.7 * v[6:], atol=1e-10)
    np.testing.assert_allclose(np.delete(difference, range(6, 24)), 0.0, atol=1e-12)


def test_contact_points(walker, state):
    q, v, _, _ = state
    positions, velocities = (out.full().ravel() for out in walker.contacts(q, v, walker.parameters()))
    expected, jacobian = walker.frames(q)
    np.testing.assert_allclose(positions, expected.ravel(), atol=1e-10)
    np.testing.assert_allclose(velocities, jacobian @ v, atol=1e-10)


def test_lateral_offsets_are_hip_minus_foot(walker, state):
    names = [segment.name for segment in walker.subject.segments]
    assert (names[RIGHT_THIGH], names[LEFT_THIGH]) == ("right_thigh", "left_thigh")
    points = walker.frames(state[0])[0].reshape(2, 2, 3)
    hips = [walker.data.oMi[walker.pinocchio.getJointId(f"{side}_thigh")].translation for side in ("right", "left")]
    expected = [hip[1] - foot[:, 1].mean() for hip, foot in zip(hips, points, strict=True)]
    np.testing.assert_allclose(walker.evaluate(state)[24:], expected, atol=1e-10)


def test_criteria_see_outputs_mass_and_stance(walker, state):
    """Torques without the root's residual, and the mass from the parameters."""
    y, stance = walker.evaluate(state), np.array([0.0, 1.0])
    found = walker.criteria(y, state[1], walker.parameters(), stance).full().ravel()
    by_name = dict(zip(ALL, found, strict=True))
    assert by_name["torque"] == pytest.approx(np.sum(y[6:24] ** 2))
    assert by_name["lateral_stability"] == pytest.approx(y[25] ** 2)
    assert by_name["peak_joint_moment"] == pytest.approx(np.sum((y[6:24] / (walker.weight / GRAVITY)) ** 8))
    assert by_name["mechanical_power"] == pytest.approx(np.sum((y[6:24] * state[1][6:]) ** 2))


def test_the_model_serves_both_children(walker):
    """Nothing numeric is in the expressions: one compiled library for every subject of this layout."""
    assert walker.layout == layout_of(thesis_cp_child())
    assert walker.parameters().size == walker.symbols.p.numel()
