"""Kinematics and inverse dynamics of a subject as CasADi expressions, for any subject of the same layout.

Everything numeric about the subject is the parameter vector `p`, so that one compiled function serves every subject.
Recursive Newton-Euler in segment frames (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 5), with joints
R = R_y(y) R_x(x) R_z(z) (thesis ch. 10) whose angular velocity in the child's frame is w = S(q) dq/dt.

World frame: the gait frame of `SubjectModel`. Only the layout decides the structure of the expressions.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from gaitlab.multibody.subject import Segment, SubjectModel

GRAVITY = 9.81
"""Acceleration of free fall [m/s^2]."""

SEGMENT_PARAMETERS = 16
"""Numbers per segment in `p`."""


@dataclass(frozen=True, kw_only=True)
class ModelLayout:
    """What is fixed when dynamics are compiled: the tree of segments and where contact points sit."""

    parents: tuple[int, ...]
    """Index of each segment's parent, -1 for the root, parents before children."""
    contact_names: tuple[str, ...]
    contact_segments: tuple[int, ...]
    """Index of the segment that carries each contact point."""

    @property
    def n_q(self) -> int:
        """Number of generalised coordinates."""
        return 3 + 3 * len(self.parents)

    @property
    def n_p(self) -> int:
        """Number of parameters of a subject."""
        return SEGMENT_PARAMETERS * len(self.parents) + 3 * len(self.contact_names)


def layout_of(subject: SubjectModel) -> ModelLayout:
    """Layout that the subject's compiled functions depend on."""
    return ModelLayout(
        parents=tuple(segment.parent for segment in subject.segments),
        contact_names=tuple(subject.contacts),
        contact_segments=tuple(point.segment for point in subject.contacts.values()),
    )


def parameter_vector(subject: SubjectModel) -> np.ndarray:
    """Everything numeric about the subject, shape (n_p,).

    Per segment: joint offset (3) [m], rotation offset (3) [rad], mass [kg], first moment of mass m c (3) [kg*m], and
    second moment of mass about the segment's origin, the integral of r r' dm (xx, yy, zz, xy, xz, yz) [kg*m^2]; then
    the contact points (3 each) [m]. Linear in the inertial parameters, and fewer operations than with the inertia.
    """
    parts = [_segment_parameters(segment) for segment in subject.segments]
    parts += [point.position for point in subject.contacts.values()]
    return np.concatenate(parts)


def _segment_parameters(segment: Segment) -> np.ndarray:
    m, c = segment.mass, segment.centre_of_mass
    second_moment = np.trace(segment.inertia) / 2 * np.eye(3) - segment.inertia + m * np.outer(c, c)
    entries = second_moment[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    return np.concatenate([segment.joint_offset, segment.rotation_offset, [m], m * c, entries])


@dataclass(frozen=True, kw_only=True)
class _Body:
    """Parameters of one segment as expressions, cut out of `p`."""

    joint_offset: ca.SX
    rotation_offset: ca.SX
    mass: ca.SX
    first_moment: ca.SX
    second_moment: ca.SX


def _body(p: ca.SX, index: int) -> _Body:
    b = p[SEGMENT_PARAMETERS * index : SEGMENT_PARAMETERS * (index + 1)]
    xx, yy, zz, xy, xz, yz = (b[i] for i in range(10, 16))
    second = ca.blockcat([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return _Body(joint_offset=b[:3], rotation_offset=b[3:6], mass=b[6], first_moment=b[7:10], second_moment=second)


def _contact(layout: ModelLayout, p: ca.SX, index: int) -> ca.SX:
    start = SEGMENT_PARAMETERS * len(layout.parents) + 3 * index
    return p[start : start + 3]


@dataclass(frozen=True, kw_only=True)
class _Joint:
    """Rotation child to parent R (3, 3), w = S dq/dt, and cosines and sines of the angles."""

    R: ca.SX
    S: ca.SX
    cosines: ca.SX
    sines: ca.SX


def _joint(angles: ca.SX) -> _Joint:
    c, s = ca.cos(angles), ca.sin(angles)
    cy, cx, cz, sy, sx, sz = c[0], c[1], c[2], s[0], s[1], s[2]
    R = ca.blockcat(
        [
            [cy * cz + sy * sx * sz, sy * sx * cz - cy * sz, sy * cx],
            [cx * sz, cx * cz, -sx],
            [cy * sx * sz - sy * cz, sy * sz + cy * sx * cz, cy * cx],
        ]
    )
    S = ca.blockcat([[sz * cx, cz, 0], [cz * cx, -sz, 0], [-sx, 0, 1]])
    return _Joint(R=R, S=S, cosines=c, sines=s)


def _velocity_product(joint: _Joint, qd: ca.SX) -> ca.SX:
    """(dS/dt) dq/dt: the part of the joint's angular acceleration that is there without ddq."""
    cx, cz, sx, sz = joint.cosines[1], joint.cosines[2], joint.sines[1], joint.sines[2]
    y, x, z = qd[0], qd[1], qd[2]
    u, w = (cx * y * z), (sx * x * y)
    return ca.vertcat(cz * u - sz * w - sz * x * z, -sz * u - cz * w - cz * x * z, -cx * x * y)


def _joints(layout: ModelLayout, p: ca.SX, q: ca.SX) -> list[_Joint]:
    return [_joint(q[3 + 3 * i : 6 + 3 * i] + _body(p, i).rotation_offset) for i in range(len(layout.parents))]


def segment_rotations(layout: ModelLayout, p: ca.SX, q: ca.SX) -> list[ca.SX]:
    """Rotation of each segment's axes to the world, shapes (3, 3)."""
    rotations: list[ca.SX] = []
    for parent, joint in zip(layout.parents, _joints(layout, p, q), strict=True):
        rotations.append(joint.R if parent < 0 else rotations[parent] @ joint.R)
    return rotations


def segment_origins(layout: ModelLayout, p: ca.SX, q: ca.SX) -> list[ca.SX]:
    """World position of each segment's origin, the centre of the joint that carries it [m], shapes (3, 1)."""
    rotations = segment_rotations(layout, p, q)
    origins: list[ca.SX] = []
    for i, parent in enumerate(layout.parents):
        offset = _body(p, i).joint_offset
        origins.append(q[:3] + offset if parent < 0 else origins[parent] + rotations[parent] @ offset)
    return origins


def contact_positions(layout: ModelLayout, p: ca.SX, q: ca.SX) -> dict[str, ca.SX]:
    """World position of each contact point [m], shapes (3, 1)."""
    rotations, origins = segment_rotations(layout, p, q), segment_origins(layout, p, q)
    return {
        name: origins[segment] + rotations[segment] @ _contact(layout, p, k)
        for k, (name, segment) in enumerate(zip(layout.contact_names, layout.contact_segments, strict=True))
    }


def contact_velocities(layout: ModelLayout, p: ca.SX, q: ca.SX, v: ca.SX) -> dict[str, ca.SX]:
    """World velocity of each contact point [m/s], shapes (3, 1)."""
    rotations, joints = segment_rotations(layout, p, q), _joints(layout, p, q)
    omegas: list[ca.SX] = []
    velocities: list[ca.SX] = []
    for i, parent in enumerate(layout.parents):
        omega = joints[i].S @ v[3 + 3 * i : 6 + 3 * i]
        if parent < 0:
            velocities.append(v[:3])
        else:
            omega += joints[i].R.T @ omegas[parent]
            velocities.append(
                velocities[parent] + rotations[parent] @ ca.cross(omegas[parent], _body(p, i).joint_offset)
            )
        omegas.append(omega)
    return {
        name: velocities[segment] + rotations[segment] @ ca.cross(omegas[segment], _contact(layout, p, k))
        for k, (name, segment) in enumerate(zip(layout.contact_names, layout.contact_segments, strict=True))
    }


def inverse_dynamics(layout: ModelLayout, p: ca.SX, q: ca.SX, v: ca.SX, a: ca.SX, forces: Mapping[str, ca.SX]) -> ca.SX:
    """Generalised forces tau = M(q) a + h(q, v) - J' f, shape (n_q, 1).

    Args:
        layout: the tree of segments.
        p: parameters of the subject, shape (n_p, 1).
        q: coordinates [m, rad], shape (n_q, 1).
        v: dq/dt [m/s, rad/s], shape (n_q, 1).
        a: d2q/dt2 [m/s^2, rad/s^2], shape (n_q, 1).
        forces: contact name to the force [N] of the ground on the foot, world frame, shape (3, 1).

    Returns:
        Force [N] on q_0..q_2 and moments [N*m] about the Y'X'Z' axes of every joint (power tau' v). The first six are
        what is missing for dynamic consistency: no muscle acts on the root.
    """
    motion = _accelerations(layout, p, q, v, a, GRAVITY)
    return _project(layout, p, motion, _wrenches(layout, p, motion, _body_forces(layout, p, q, forces)))


def impact_balance(layout: ModelLayout, p: ca.SX, q: ca.SX, jump: ca.SX, impulses: Mapping[str, ca.SX]) -> ca.SX:
    """M(q) (v+ - v-) - J' Lambda, shape (n_q, 1), zero in an impact; jump v+ - v-, impulses Lambda [N*s], world."""
    motion = _accelerations(layout, p, q, ca.SX(layout.n_q, 1), jump, 0.0)
    return _project(layout, p, motion, _wrenches(layout, p, motion, _body_forces(layout, p, q, impulses)))


@dataclass(frozen=True, kw_only=True)
class _Motion:
    """Per segment, in its own axes: joint, angular velocity and acceleration, A, acceleration of the origin minus g.

    A = [alpha x] + [omega x]^2 takes a point r to its acceleration relative to the origin.
    """

    joints: list[_Joint]
    omega: list[ca.SX]
    alpha: list[ca.SX]
    A: list[ca.SX]
    acceleration: list[ca.SX]


def _accelerations(layout: ModelLayout, p: ca.SX, q: ca.SX, v: ca.SX, a: ca.SX, gravity: float) -> _Motion:
    motion = _Motion(joints=_joints(layout, p, q), omega=[], alpha=[], A=[], acceleration=[])
    for i, parent in enumerate(layout.parents):
        joint, qd, qdd = motion.joints[i], v[3 + 3 * i : 6 + 3 * i], a[3 + 3 * i : 6 + 3 * i]
        omega = joint.S @ qd
        alpha = joint.S @ qdd + _velocity_product(joint, qd)
        if parent < 0:
            acceleration = joint.R.T @ (a[:3] + ca.vertcat(0, 0, gravity))
        else:
            carried = joint.R.T @ motion.omega[parent]
            alpha += joint.R.T @ motion.alpha[parent] + ca.cross(carried, omega)
            omega += carried
            acceleration = joint.R.T @ (motion.acceleration[parent] + motion.A[parent] @ _body(p, i).joint_offset)
        motion.omega.append(omega)
        motion.alpha.append(alpha)
        motion.A.append(_rotational_acceleration(omega, alpha))
        motion.acceleration.append(acceleration)
    return motion


def _rotational_acceleration(omega: ca.SX, alpha: ca.SX) -> ca.SX:
    """A = [alpha x] + [omega x]^2, shape (3, 3)."""
    x, y, z = omega[0], omega[1], omega[2]
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    return ca.blockcat(
        [
            [-(yy + zz), xy - alpha[2], xz + alpha[1]],
            [xy + alpha[2], -(xx + zz), yz - alpha[0]],
            [xz - alpha[1], yz + alpha[0], -(xx + yy)],
        ]
    )


def _body_forces(
    layout: ModelLayout, p: ca.SX, q: ca.SX, forces: Mapping[str, ca.SX]
) -> dict[int, tuple[ca.SX, ca.SX]]:
    """Force and moment about the segment's origin of the contact forces, segment's axes, for each loaded segment."""
    rotations = segment_rotations(layout, p, q) if forces else []
    loads: dict[int, tuple[ca.SX, ca.SX]] = {}
    for name, force in forces.items():
        k = layout.contact_names.index(name)
        segment = layout.contact_segments[k]
        local = rotations[segment].T @ force
        total, moment = loads.get(segment, (ca.SX(3, 1), ca.SX(3, 1)))
        loads[segment] = total + local, moment + ca.cross(_contact(layout, p, k), local)
    return loads


def _wrenches(
    layout: ModelLayout, p: ca.SX, motion: _Motion, loads: Mapping[int, tuple[ca.SX, ca.SX]]
) -> list[tuple[ca.SX, ca.SX]]:
    """Force and moment about its origin that each segment alone needs beside its loads, segment's axes."""
    wrenches: list[tuple[ca.SX, ca.SX]] = []
    for i in range(len(layout.parents)):
        body, A, acceleration = _body(p, i), motion.A[i], motion.acceleration[i]
        force = body.mass * acceleration + A @ body.first_moment
        K = A @ body.second_moment
        spin = ca.vertcat(K[2, 1] - K[1, 2], K[0, 2] - K[2, 0], K[1, 0] - K[0, 1])
        moment = spin + ca.cross(body.first_moment, acceleration)
        applied = loads.get(i)
        wrenches.append((force, moment) if applied is None else (force - applied[0], moment - applied[1]))
    return wrenches


def _project(layout: ModelLayout, p: ca.SX, motion: _Motion, wrenches: list[tuple[ca.SX, ca.SX]]) -> ca.SX:
    """Carry wrenches from the leaves to the root and project them on the joints' coordinates."""
    total = list(wrenches)
    tau: list[ca.SX] = []
    for i in reversed(range(len(layout.parents))):
        joint, parent = motion.joints[i], layout.parents[i]
        force, moment = total[i]
        tau.insert(0, joint.S.T @ moment)
        carried = joint.R @ force
        if parent < 0:
            tau.insert(0, carried)
            continue
        lever = ca.cross(_body(p, i).joint_offset, carried)
        total[parent] = (total[parent][0] + carried, total[parent][1] + joint.R @ moment + lever)
    return ca.vertcat(*tau)
