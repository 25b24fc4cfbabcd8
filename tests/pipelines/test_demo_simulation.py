"""Forward dynamics of the demo walks against Pinocchio and against its own constraints."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from gaitlab.multibody.pinocchio_model import to_pinocchio
from gaitlab.multibody.presets import thesis_able_bodied_child
from gaitlab.pipelines.demo_simulation import ForwardDynamics
from gaitlab.walking.model import POINTS

FLAT_RIGHT = [0, 1, 2, 4, 5]


@pytest.fixture(scope="module")
def body():
    child = thesis_able_bodied_child()
    return replace(child, contacts={name: child.contacts[name] for name in POINTS})


@pytest.fixture(scope="module")
def state(body):
    generator = np.random.default_rng(3)
    return np.concatenate([generator.uniform(-0.4, 0.4, body.n_q), generator.uniform(-1.0, 1.0, body.n_q)])


def test_without_contact_accelerations_are_those_of_pinocchio(body, state):
    torques = np.linspace(-5.0, 5.0, body.n_q - 6)
    found, forces = ForwardDynamics(body)(state, torques, [], np.zeros(12))
    model = to_pinocchio(body)
    expected = pin.aba(model, model.createData(), *np.split(state, 2), np.concatenate([np.zeros(6), torques]))
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)
    assert not forces.any()


def test_points_in_contact_do_not_accelerate(body, state):
    dynamics = ForwardDynamics(body)
    still = np.concatenate([state[: body.n_q], np.zeros(body.n_q)])
    place = dynamics.places(still[: body.n_q])
    acceleration, forces = dynamics(still, np.zeros(body.n_q - 6), FLAT_RIGHT, place)
    step = 1e-4
    moved = dynamics.places(still[: body.n_q] + 0.5 * step**2 * acceleration) - place
    np.testing.assert_allclose(moved[FLAT_RIGHT] / (0.5 * step**2), 0.0, atol=1e-3)
    assert np.flatnonzero(forces).tolist() == FLAT_RIGHT
