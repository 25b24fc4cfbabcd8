import numpy as np
import pinocchio as pin
import pytest

from gaitlab.multibody.pinocchio_model import to_pinocchio
from gaitlab.multibody.presets import thesis_able_bodied_child, thesis_cp_child

CHILDREN = {"cp": (thesis_cp_child, 39.2), "able-bodied": (thesis_able_bodied_child, 51.0)}


@pytest.fixture(params=CHILDREN)
def child(request):
    return CHILDREN[request.param]


def test_coordinates_and_printed_mass(child):
    build, mass = child
    assert build().n_q == 24
    assert build(trunk_joint=True).n_q == 27
    assert build().mass == pytest.approx(0.9604 * mass)
    assert build(trunk_joint=True).mass == pytest.approx(0.9604 * mass)


def test_trunk_joint_at_zero_is_the_rigid_trunk(child):
    """Same whole-body inertia matrix in the 24 shared coordinates."""
    build, _ = child
    rigid, jointed = to_pinocchio(build()), to_pinocchio(build(trunk_joint=True))
    q = np.concatenate([0.3 * np.random.default_rng(1).normal(size=24), np.zeros(3)])
    M = pin.crba(rigid, rigid.createData(), q[:24])
    np.testing.assert_allclose(pin.crba(jointed, jointed.createData(), q)[:24, :24], M, atol=1e-12)


def test_feet_point_forward_and_outward_in_the_neutral_position():
    """Tibial torsion turns toes outwards: right to the right (-y), left to the left."""
    child = thesis_cp_child()
    model = to_pinocchio(child)
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.zeros(24))
    for side, outward in (("right", -1), ("left", 1)):
        ankle = data.oMf[model.getFrameId(f"{side}_foot")].translation
        toe = data.oMf[model.getFrameId(f"{side}_toe")].translation - ankle
        assert toe[0] > 0.9 * np.linalg.norm(toe) * np.cos(0.6)
        assert outward * toe[1] > 0
