import numpy as np
import pytest

from gaitlab.inverse.dynamics import GRAVITY, Wrench, angular_velocity, leg_loads
from gaitlab.multibody.kinematics import rotation_matrices
from gaitlab.multibody.rigid_body import RigidBody
from gaitlab.multibody.scaling import SegmentPose
from gaitlab.signal.derivatives import derivative

RATE, N = 1000.0, 400
TIME = np.arange(N) / RATE
INNER = slice(5, -5)
LENGTHS = {"thigh": 0.4, "shank": 0.38, "foot": 0.12}
BODIES = {
    f"left_{name}": RigidBody(
        mass=mass, centre_of_mass=np.array([0.01, 0.0, -0.4 * LENGTHS[name]]), inertia=np.diag([a, b, c])
    )
    for name, mass, a, b, c in (
        ("thigh", 7.0, 0.12, 0.11, 0.03),
        ("shank", 3.0, 0.05, 0.04, 0.01),
        ("foot", 1.0, 4e-3, 3e-3, 1e-3),
    )
}
NO_GROUND = Wrench(point=np.zeros((N, 3)), force=np.zeros((N, 3)), moment=np.zeros((N, 3)))


def chain(amplitude):
    """A leg that swings in all three planes below a pelvis that moves and turns."""
    wave = [np.sin(TIME[:, None] * (5.0 + k) + np.array([0.0, 1.0, 2.0]) + k) for k in range(4)]
    rotation = rotation_matrices(amplitude * wave[0])
    origin = amplitude * np.stack([np.sin(4 * TIME), np.cos(3 * TIME), np.sin(6 * TIME)], axis=1) + [0.0, 0.0, 1.0]
    poses = {"pelvis": SegmentPose(origin=origin, rotation=rotation)}
    for k, (name, length) in enumerate(LENGTHS.items()):
        rotation = rotation @ rotation_matrices(amplitude * wave[k + 1])
        poses[f"left_{name}"] = SegmentPose(origin=origin, rotation=rotation)
        origin = origin - length * rotation[:, :, 2]
    return poses


def energy(poses):
    total = np.zeros(N)
    for name, body in BODIES.items():
        pose = poses[name]
        centre = pose.origin + pose.rotation @ body.centre_of_mass
        local = np.einsum("nji,nj->ni", pose.rotation, angular_velocity(pose.rotation, RATE))
        total += body.mass * ((derivative(centre, RATE) ** 2).sum(axis=1) / 2 - centre @ GRAVITY)
        total += np.einsum("ni,ij,nj->n", local, body.inertia, local) / 2
    return total


def test_angular_velocity_of_a_steady_turn():
    angle = 3.0 * TIME
    rotation = rotation_matrices(np.stack([np.zeros(N), np.zeros(N), angle], axis=1))
    assert angular_velocity(rotation, RATE)[INNER] == pytest.approx(np.broadcast_to([0.0, 0.0, 3.0], (N - 10, 3)), 1e-4)


def test_work_of_joints_and_ground_is_the_change_of_energy():
    poses = chain(0.3)
    push = np.stack([np.sin(9 * TIME), np.cos(7 * TIME), 3.0 + np.sin(TIME)], axis=1)
    heel = poses["left_foot"].origin - 0.1 * poses["left_foot"].rotation[:, :, 2]
    loads = leg_loads("left", poses, BODIES, Wrench(point=heel, force=50 * push, moment=2 * push), RATE)
    omega = {name: angular_velocity(poses[name].rotation, RATE) for name in ("pelvis", "left_foot")}
    power = sum(load.power for load in loads.values())
    power += (loads["hip"].moment * omega["pelvis"]).sum(axis=1)
    power += (loads["hip"].force * derivative(poses["pelvis"].origin, RATE)).sum(axis=1)
    power += (50 * push * derivative(heel, RATE)).sum(axis=1) + (2 * push * omega["left_foot"]).sum(axis=1)
    change = derivative(energy(poses)[:, None], RATE)[:, 0]
    assert np.abs(power - change)[INNER].max() < 2e-3 * np.abs(change).max()


def test_a_leg_at_rest_carries_its_own_weight():
    loads = leg_loads("left", chain(0.0), BODIES, NO_GROUND, RATE)
    assert loads["hip"].force[10] == pytest.approx([0.0, 0.0, 11.0 * 9.81])
    assert loads["hip"].moment[10] == pytest.approx([0.0, -0.11 * 9.81, 0.0])  # each centre lies 1 cm ahead
    assert loads["hip"].power[10] == pytest.approx(0.0)


def test_the_ground_below_the_toes_is_held_by_the_calf():
    poses = chain(0.0)
    toes = poses["left_foot"].origin + [0.15, 0.0, -0.12]
    force = np.broadcast_to([0.0, 0.0, 700.0], (N, 3))
    loads = leg_loads("left", poses, BODIES, Wrench(point=toes, force=force, moment=np.zeros((N, 3))), RATE)
    assert loads["ankle"].moment[10, 1] == pytest.approx(0.15 * 700.0 - 0.01 * 9.81)
    assert loads["knee"].force[10, 2] == pytest.approx(4.0 * 9.81 - 700.0)


def test_an_unknown_ground_leaves_everything_above_it_unknown():
    force = np.zeros((N, 3))
    force[100:110] = np.nan
    loads = leg_loads("left", chain(0.1), BODIES, Wrench(point=force * 0, force=force, moment=force), RATE)
    for load in loads.values():
        assert np.isnan(load.moment[100:110]).all()
        assert np.isfinite(load.moment[50:90]).all()
