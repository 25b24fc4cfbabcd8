"""CasADi dynamics against Pinocchio at random states."""

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from gaitlab.multibody import dynamics
from gaitlab.multibody.pinocchio_model import to_pinocchio
from gaitlab.multibody.presets import thesis_cp_child

TOLERANCE = 1e-9


class Compiled:
    """Our functions and Pinocchio's model of one subject."""

    def __init__(self, subject):
        self.layout = layout = dynamics.layout_of(subject)
        self.names = layout.contact_names
        self.parameters = dynamics.parameter_vector(subject)
        p = ca.SX.sym("p", layout.n_p)
        q, v, a = (ca.SX.sym(name, layout.n_q) for name in "qva")
        f = ca.SX.sym("f", 3, len(self.names))
        forces = {name: f[:, k] for k, name in enumerate(self.names)}
        points = ca.horzcat(*dynamics.contact_positions(layout, p, q).values())
        speeds = ca.horzcat(*dynamics.contact_velocities(layout, p, q, v).values())
        origins = ca.horzcat(*dynamics.segment_origins(layout, p, q))
        self.torques = ca.Function("t", [p, q, v, a, f], [dynamics.inverse_dynamics(layout, p, q, v, a, forces)])
        self.impact = ca.Function("i", [p, q, a, f], [dynamics.impact_balance(layout, p, q, a, forces)])
        self.places = ca.Function("k", [p, q, v], [points, speeds, origins, ca.jacobian(points, q)])
        self.model = to_pinocchio(subject)
        self.data = self.model.createData()

    def contact_jacobian(self, q):
        pin.computeJointJacobians(self.model, self.data, q)
        pin.updateFramePlacements(self.model, self.data)
        world = pin.LOCAL_WORLD_ALIGNED
        ids = [self.model.getFrameId(name) for name in self.names]
        return np.vstack([pin.getFrameJacobian(self.model, self.data, i, world)[:3] for i in ids])


@pytest.fixture(scope="module", params=["random", "thesis"])
def compiled(request, random_subject):
    return Compiled(random_subject if request.param == "random" else thesis_cp_child())


@pytest.fixture(params=range(10))
def state(request, compiled):
    generator = np.random.default_rng(request.param)
    q, v, a = generator.normal(size=(3, compiled.layout.n_q))
    return q, v, a, 100 * generator.normal(size=(3, len(compiled.names)))


def test_inverse_dynamics(compiled, state):
    q, v, a, f = state
    expected = pin.rnea(compiled.model, compiled.data, q, v, a) - compiled.contact_jacobian(q).T @ f.T.ravel()
    ours = compiled.torques(compiled.parameters, q, v, a, f).full().ravel()
    np.testing.assert_allclose(ours, expected, rtol=TOLERANCE, atol=TOLERANCE)


def test_mass_matrix(compiled, state):
    q, n = state[0], compiled.layout.n_q
    columns = [compiled.impact(compiled.parameters, q, e, 0).full().ravel() for e in np.eye(n)]
    expected = pin.crba(compiled.model, compiled.data, q)
    np.testing.assert_allclose(np.array(columns).T, expected, rtol=TOLERANCE, atol=TOLERANCE)


def test_contact_positions_velocities_and_jacobian(compiled, state):
    q, v, _, _ = state
    J = compiled.contact_jacobian(q)
    frames = [compiled.data.oMf[compiled.model.getFrameId(name)].translation for name in compiled.names]
    points, speeds, _, jacobian = (x.full() for x in compiled.places(compiled.parameters, q, v))
    np.testing.assert_allclose(points.T, frames, rtol=TOLERANCE, atol=TOLERANCE)
    np.testing.assert_allclose(speeds.T.ravel(), J @ v, rtol=TOLERANCE, atol=TOLERANCE)
    np.testing.assert_allclose(jacobian, J, rtol=TOLERANCE, atol=TOLERANCE)


def test_segment_origins(compiled, state):
    q, v, _, _ = state
    pin.forwardKinematics(compiled.model, compiled.data, q)
    expected = [placement.translation for placement in list(compiled.data.oMi)[1:]]
    ours = compiled.places(compiled.parameters, q, v)[2].full().T
    np.testing.assert_allclose(ours, expected, rtol=TOLERANCE, atol=TOLERANCE)


def test_impact_stops_the_landing_points(compiled, state):
    """Velocities and impulses of Pinocchio's impulse dynamics satisfy our impact balance."""
    q, v, _, _ = state
    J = compiled.contact_jacobian(q)[:3]
    after = pin.impulseDynamics(compiled.model, compiled.data, q, v, J, 0.0, 0.0)
    impulses = np.zeros((3, len(compiled.names)))
    impulses[:, 0] = compiled.data.impulse_c
    residual = compiled.impact(compiled.parameters, q, after - v, impulses).full()
    scale = np.abs(impulses).max()
    np.testing.assert_allclose(residual / scale, 0, atol=TOLERANCE)
    np.testing.assert_allclose(J @ after, 0, atol=TOLERANCE)


def test_compiled_functions_serve_another_subject_of_the_same_layout(compiled, state):
    heavier = compiled.parameters.copy()
    size = dynamics.SEGMENT_PARAMETERS
    heavier[: size * len(compiled.layout.parents)].reshape(-1, size)[:, 6:] *= 2  # masses and their moments
    q, v, a, _ = state
    once, twice = (compiled.torques(p, q, v, a, 0).full() for p in (compiled.parameters, heavier))
    np.testing.assert_allclose(twice, 2 * once, rtol=TOLERANCE)
