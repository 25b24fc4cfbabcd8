"""Least-load posture of the subject model: statics against Pinocchio, constraints, and SLSQP on the same problem."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import minimize

from gaitlab.errors import ProblemError
from gaitlab.multibody.kinematics import forward_kinematics, point_positions
from gaitlab.multibody.pinocchio_model import to_pinocchio
from gaitlab.multibody.presets import thesis_able_bodied_child
from gaitlab.nlp.null_space.method import NullSpaceProjection
from gaitlab.walking.posture import PostureProblem, least_load_posture

INDEPENDENT = [0, 1, 2, 4, 5, 6, 7, 8, 10, 11, 12, 13]
"""Rows of the equality constraints without those that heel, toe and the foot's length imply."""


def crouching(child):
    """A bent, twisted posture with all contact points on the floor's side."""
    q = np.zeros(child.n_q)
    q[2] = 0.8
    q[3:] = 0.1 * np.random.default_rng(0).normal(size=child.n_q - 3)
    q[9] = q[18] = 0.3
    return q


@pytest.fixture(scope="module")
def problem():
    child = thesis_able_bodied_child()
    return PostureProblem(subject=child, measured=crouching(child))


def test_static_load_against_pinocchio(problem):
    model = to_pinocchio(problem.subject)
    data, load = model.createData(), problem.load(problem.measured)
    expected = pin.computeGeneralizedGravity(model, data, problem.measured).copy()
    pin.computeJointJacobians(model, data, problem.measured)
    pin.updateFramePlacements(model, data)
    for name, force in zip(problem.subject.contacts, load.forces, strict=True):
        frame = model.getFrameId(name)
        expected -= pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3].T @ force
    np.testing.assert_allclose(expected[6:], load.torques, atol=1e-6)
    np.testing.assert_allclose(expected[:6], 0.0, atol=1e-5)
    assert load.forces[:, 2].sum() == pytest.approx(problem.weight, rel=1e-6)


def test_no_other_ground_forces_load_the_joints_less(problem):
    """Forces along the line between the feet leave the balance alone."""
    best, layout = problem.load(problem.measured), problem._functions["load"]
    spread = layout(problem.measured)[1].full()
    balanced = np.linalg.svd(spread[:6])[2][6:]  # (6, 12)
    for direction in balanced:
        for sign in (1.0, -1.0):
            torques = best.torques + spread[6:] @ (sign * 5.0 * direction)
            assert torques @ torques > 0.999 * best.torques @ best.torques


def test_a_few_iterations_improve_the_posture_and_keep_the_feet(problem):
    solution = least_load_posture(problem, NullSpaceProjection(max_iter=4))
    child, places = problem.subject, [problem.measured[None], solution.x[None]]
    before, after = (point_positions(child, child.contacts, q) for q in places)
    for name in child.contacts:
        np.testing.assert_allclose(after[name], before[name], atol=1e-3)
    trunk = forward_kinematics(child, places[1]).rotations[0, 0] @ child.segments[0].centre_of_mass
    np.testing.assert_allclose(trunk[:2], 0.0, atol=1e-3)
    assert solution.cost < problem.cost(problem.measured)
    assert problem.inequality(solution.x).max() < 1e-3


def test_two_points_balance_only_some_postures(problem):
    contacts = {name: problem.subject.contacts[name] for name in ("right_heel", "left_heel")}
    narrow = replace(problem, subject=replace(problem.subject, contacts=contacts))
    black_box = narrow.black_box()
    assert len(black_box.equality(narrow.measured)) == len(black_box.equality_names) == 6 + 2 + 6
    assert np.abs(black_box.equality(narrow.measured)[-6:]).max() > 1e-3


def test_malformed_coordinates(problem):
    with pytest.raises(ProblemError, match="shape"):
        replace(problem, measured=np.zeros(3))


@pytest.mark.slow
def test_the_optimum_is_that_of_slsqp(problem):
    ours = least_load_posture(problem)
    constraints = (
        {"type": "eq", "fun": lambda q: problem.equality(q)[INDEPENDENT]},
        {"type": "ineq", "fun": lambda q: -problem.inequality(q)},
    )
    theirs = minimize(problem.cost, problem.measured, method="SLSQP", constraints=constraints)
    assert ours.solved
    assert theirs.success
    assert ours.cost == pytest.approx(theirs.fun, rel=0.01)
