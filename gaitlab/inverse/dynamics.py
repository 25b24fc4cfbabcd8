"""Inverse dynamics of a leg: net forces and moments of ankle, knee and hip from measured motion and ground reaction.

Recursive Newton-Euler from the foot upwards (Winter, Biomechanics and Motor Control of Human Movement, ch. 5 and 7).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gaitlab.inverse.conventional_geometry import cross
from gaitlab.mocap.recording import Side
from gaitlab.multibody.rigid_body import RigidBody
from gaitlab.multibody.scaling import SegmentPose
from gaitlab.signal.derivatives import derivative, second_derivative

GRAVITY = np.array([0.0, 0.0, -9.81])  # m/s^2, laboratory frame
CHAIN = (("ankle", "foot", "shank"), ("knee", "shank", "thigh"), ("hip", "thigh", "pelvis"))
"""Joint, the segment below it and the segment above it, from the ground upwards."""
Poses = Mapping[str, SegmentPose]
"""pelvis, left_thigh, left_shank, left_foot ...: origin at the proximal joint."""
Bodies = Mapping[str, RigidBody]
"""left_thigh, left_shank, left_foot ... in the frames of the poses."""


@dataclass(frozen=True, kw_only=True)
class Wrench:
    """Force and moment per frame, laboratory frame."""

    point: np.ndarray
    """Where the force is applied [m], shape (n, 3)."""
    force: np.ndarray
    """[N], shape (n, 3)."""
    moment: np.ndarray
    """About `point` [N*m], shape (n, 3)."""

    def about(self, point: np.ndarray) -> np.ndarray:
        """Moment about another point (n, 3) [m]: M + (p - point) x F [N*m], shape (n, 3)."""
        return self.moment + cross(self.point - point, self.force)


@dataclass(frozen=True, kw_only=True)
class JointLoad:
    """What the proximal segment exerts on the distal one at a joint, laboratory frame."""

    force: np.ndarray
    """[N], shape (n, 3)."""
    moment: np.ndarray
    """About the joint centre: the net moment of muscles and ligaments [N*m], shape (n, 3)."""
    power: np.ndarray
    """moment . (omega_distal - omega_proximal) [W], positive when the muscles generate, shape (n,)."""


def leg_loads(side: Side, poses: Poses, bodies: Bodies, ground: Wrench, rate: float) -> dict[str, JointLoad]:
    """Loads of ankle, knee and hip of one leg, by name of the joint.

    For each segment with mass m, centre of mass c, proximal joint p, all loads from below summed to (F_d, M_d about c):
        F_p = m (ddc - g) - F_d
        M_p = d/dt (R I R^T omega) - M_d - (p - c) x F_p
    Derivatives are central differences of the poses as given: filter the markers before, if at all.

    Args:
        side: Which leg.
        poses: Of pelvis and the leg's three segments, laboratory frame, shapes (n, 3) [m] and (n, 3, 3).
        bodies: Mass properties of the leg's segments.
        ground: What the ground exerts on the foot; zero while the foot is in the air, NaN where unknown.
        rate: Frames per second [Hz].
    """
    omega = {
        name: angular_velocity(poses[key].rotation, rate)
        for name, key in [("pelvis", "pelvis"), *((kind, f"{side}_{kind}") for kind in ("thigh", "shank", "foot"))]
    }
    loads: dict[str, JointLoad] = {}
    below = ground
    for joint, distal, proximal in CHAIN:
        pose, body = poses[f"{side}_{distal}"], bodies[f"{side}_{distal}"]
        centre = pose.origin + pose.rotation @ body.centre_of_mass
        force = body.mass * (second_derivative(centre, rate) - GRAVITY) - below.force
        spin = derivative(_angular_momentum(pose.rotation, body.inertia, omega[distal]), rate)
        moment = spin - below.about(centre) - cross(pose.origin - centre, force)
        power = np.einsum("ij,ij->i", moment, omega[distal] - omega[proximal])
        loads[joint] = JointLoad(force=force, moment=moment, power=power)
        below = Wrench(point=pose.origin, force=-force, moment=-moment)
    return loads


def angular_velocity(rotation: np.ndarray, rate: float) -> np.ndarray:
    """Angular velocity [rad/s] of axes R (n, 3, 3) in the outer frame, shape (n, 3): the skew part of dR/dt R^T.

    `rate` in frames per second [Hz]; NaN stays NaN.
    """
    n = len(rotation)
    spin = derivative(rotation.reshape(n, 9), rate).reshape(n, 3, 3) @ np.swapaxes(rotation, 1, 2)
    skew = (spin - np.swapaxes(spin, 1, 2)) / 2
    return np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)


def _angular_momentum(rotation: np.ndarray, inertia: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """R I R^T omega [kg*m^2/s], outer frame, shape (n, 3)."""
    local = np.einsum("nji,nj->ni", rotation, omega) @ inertia  # the inertia is symmetric
    return np.einsum("nij,nj->ni", rotation, local)
