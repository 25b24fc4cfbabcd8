"""Reference gaits of the demo recordings: periodic coordinates whose feet stand where they touch the floor.

The coordinates are periodic quintic splines plus steady progression. A nonlinear least-squares problem keeps them close
to the pattern's curves, keeps the contact points in place and at height zero while they touch, and lifts them in swing.
"""

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
import scipy.sparse as sp
from scipy.interpolate import BSpline
from scipy.sparse.linalg import spsolve

from ..mocap.recording import Side
from ..multibody.dynamics import contact_positions, layout_of, parameter_vector
from ..multibody.kinematics import rotation_matrices
from ..multibody.subject import SubjectModel
from .demo_patterns import SIDES, SIGN, GaitPattern

DEGREE = 5
N_NODES, N_SAMPLES = 50, 200
N_ITERATIONS = 12
STAYS = 2e-4  # [m], standard deviation of a contact point from its place
LIFTS = 3e-3  # [m], of the clearance
ANGLE, MINOR_ANGLE, ROOT_ANGLE = np.radians([4.0, 4.0, 2.0])
TRANSLATION = (0.03, 0.01, 0.05)  # [m], x, y, z
BENDING, ROOT_BENDING = 20.0, 2.0  # [rad/s^2] and [m/s^2], of the accelerations beyond the pattern's
WIDTH = 0.005  # [m], of the lateral place of a foot
FIRST_JOINT = {"right": 6, "left": 15}


@dataclass(frozen=True, kw_only=True)
class ReferenceGait:
    """A periodic gait, time 0 at a right foot strike, gait frame."""

    subject: SubjectModel
    pattern: GaitPattern
    coefficients: np.ndarray
    """Of the periodic B-splines, shape (N_NODES, n_q) [m, rad]."""

    def coordinates(self, time: np.ndarray, derivative: int = 0) -> np.ndarray:
        """Coordinates q or a derivative at times (n,) [s], shape (n, n_q) [m, rad, 1/s^derivative]."""
        period = self.pattern.stride_time
        q = basis(time / period, derivative) @ self.coefficients / period**derivative
        q[:, 0] += self.pattern.speed * (time if derivative == 0 else float(derivative == 1))
        return q


def basis(share: np.ndarray, derivative: int = 0) -> sp.csr_matrix:
    """Periodic B-splines (or derivatives) at shares of the cycle (n,), shape (n, N_NODES)."""
    knots = np.arange(-DEGREE, N_NODES + DEGREE + 1.0)
    x = (share % 1.0) * N_NODES
    if derivative == 0:
        table = BSpline.design_matrix(x, knots, DEGREE).tocoo()
    else:
        splines = BSpline(knots, np.eye(N_NODES + DEGREE), DEGREE).derivative(derivative)
        table = sp.coo_matrix(splines(x) * float(N_NODES) ** derivative)
    return sp.csr_matrix((table.data, (table.row, table.col % N_NODES)), shape=(len(share), N_NODES))


def in_contact(pattern: GaitPattern, side: Side, part: str, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Whether heel or toe touches at times (n,) [s] after a right strike, and the stride that the contact belongs to.

    Both of shape (n,); the second is 0 for contacts that begin in the side's first stride.
    """
    start, end = getattr(pattern.contacts[side], part)
    own = time - pattern.delay(side) - start
    stride = np.floor(own / pattern.stride_time + 1e-9)
    return own - stride * pattern.stride_time < end - start - 1e-9, stride


def flat_ankle(subject: SubjectModel, side: Side) -> float:
    """Coordinate y of the ankle [rad] that lays the sole across the shank."""
    foot = subject.segments[3 if side == "right" else 6]
    sole = subject.contacts[f"{side}_toe"].position - subject.contacts[f"{side}_heel"].position
    turned = rotation_matrices(foot.rotation_offset * [0.0, 1.0, 1.0]) @ sole
    return float(np.arctan2(turned[2], turned[0]) - foot.rotation_offset[0])


def target_coordinates(subject: SubjectModel, pattern: GaitPattern, share: np.ndarray) -> np.ndarray:
    """Coordinates that the pattern asks for, without progression, at shares of the cycle (n,), shape (n, n_q).

    The subject's pelvis has the axes of the conventional gait model.
    """
    q = np.zeros((len(share), subject.n_q))
    middle = pattern.contacts["right"].stance / pattern.stride_time / 2
    legs = sum(-segment.joint_offset[2] for segment in subject.segments[2:4])
    q[:, 1] = -pattern.sway * np.cos(2 * np.pi * (share - middle))
    q[:, 2] = 0.96 * legs + 0.04 * 1.5 + pattern.rise * np.cos(4 * np.pi * (share - middle))
    q[:, 3] = pattern.curve("pelvis_tilt", share)
    q[:, 4] = -pattern.curve("pelvis_obliquity", share)
    q[:, 5] = pattern.curve("pelvis_rotation", share)
    for side in SIDES:
        s, first, own = SIGN[side], FIRST_JOINT[side], share - pattern.delay(side) / pattern.stride_time
        q[:, first] = -pattern.curve("hip_flexion", own)
        q[:, first + 1] = -s * pattern.curve("hip_adduction", own)
        q[:, first + 2] = -s * pattern.curve("hip_rotation", own)
        q[:, first + 3] = pattern.curve("knee_flexion", own)
        q[:, first + 6] = flat_ankle(subject, side) - pattern.curve("ankle_dorsiflexion", own)
    return q


def reference_gait(pattern: GaitPattern, subject: SubjectModel) -> ReferenceGait:
    """The pattern's gait on a subject with feet that stand."""
    fit = _Fit(subject=subject, pattern=pattern)
    coefficients, places = fit.start()
    for _ in range(N_ITERATIONS):
        coefficients, places = fit.improved(coefficients, places)
    return ReferenceGait(subject=subject, pattern=pattern, coefficients=coefficients)


@dataclass(frozen=True)
class _Fit:
    """Gauss-Newton for the coefficients and the places (x, y) [m] where heels and toes stand."""

    subject: SubjectModel
    pattern: GaitPattern

    @cached_property
    def share(self) -> np.ndarray:
        """Samples, shares of the cycle, shape (N_SAMPLES,)."""
        return np.arange(N_SAMPLES) / N_SAMPLES

    @cached_property
    def time(self) -> np.ndarray:
        """Samples [s], shape (N_SAMPLES,)."""
        return self.share * self.pattern.stride_time

    @cached_property
    def target(self) -> np.ndarray:
        """Coordinates of the pattern, shape (N_SAMPLES, n_q)."""
        return target_coordinates(self.subject, self.pattern, self.share)

    @cached_property
    def spread(self) -> np.ndarray:
        """Standard deviations of the coordinates [m, rad], shape (n_q,)."""
        spread = np.full(self.subject.n_q, MINOR_ANGLE)
        spread[:3], spread[3:6] = TRANSLATION, ROOT_ANGLE
        spread[[6, 9, 12, 15, 18, 21]] = ANGLE
        return spread

    @cached_property
    def contacts(self) -> ca.Function:
        """Positions (12, n) [m] and their Jacobians (12, 24 n) of coordinates (24, n)."""
        layout, q = layout_of(self.subject), ca.SX.sym("q", self.subject.n_q)
        positions = contact_positions(layout, ca.SX(parameter_vector(self.subject)), q)
        stacked = ca.vertcat(*[positions[name] for name in self.subject.contacts])
        return ca.Function("contacts", [q], [stacked, ca.densify(ca.jacobian(stacked, q))]).map(N_SAMPLES)

    def start(self) -> tuple[np.ndarray, np.ndarray]:
        """Coefficients (N_NODES, n_q) next to the pattern and no places yet, shape (4, 2)."""
        E = basis(self.share)
        coefficients = np.asarray(spsolve((E.T @ E).tocsc(), E.T @ self.target))
        return coefficients, np.zeros((4, 2))

    def improved(self, coefficients: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """One full step."""
        n_q = self.subject.n_q
        E, E2 = basis(self.share), basis(self.share, 2) / self.pattern.stride_time**2
        rows: list[sp.csr_matrix] = []
        residuals: list[np.ndarray] = []
        wanted = E2 @ spsolve((E.T @ E).tocsc(), E.T @ self.target)
        for table, goal, spread in (
            (E, self.target, self.spread),
            (E2, wanted, np.repeat([ROOT_BENDING, BENDING], [3, n_q - 3])),
        ):
            weighted = sp.kron(table, sp.diags(1 / spread))
            rows.append(sp.csr_matrix(sp.hstack([weighted, sp.csr_matrix((N_SAMPLES * n_q, 8))])))
            residuals.append((((table @ coefficients) - goal) / spread).ravel())
        by_q, by_place, contact = self._contact_rows(E @ coefficients, places)
        rows.append(sp.csr_matrix(sp.hstack([by_q @ sp.kron(E, sp.eye(n_q)), by_place])))
        residuals.append(contact)
        rows.append(sp.csr_matrix(sp.hstack([sp.csr_matrix((4, coefficients.size)), self._lateral / WIDTH])))
        residuals.append((places[:, 1] - self._width) / WIDTH)
        J, r = sp.csr_matrix(sp.vstack(rows)), np.concatenate(residuals)
        step = np.asarray(spsolve((J.T @ J + 1e-9 * sp.eye(coefficients.size + 8)).tocsc(), -(J.T @ r)))
        return coefficients + step[:-8].reshape(coefficients.shape), places + step[-8:].reshape(4, 2)

    @cached_property
    def _lateral(self) -> sp.csr_matrix:
        return sp.csr_matrix((np.ones(4), (np.arange(4), 2 * np.arange(4) + 1)), shape=(4, 8))

    @cached_property
    def _width(self) -> np.ndarray:
        signs = [SIGN["right" if name.startswith("right") else "left"] for name in self.subject.contacts]
        return self.pattern.half_width * np.array(signs)

    def _contact_rows(self, q: np.ndarray, places: np.ndarray) -> tuple[sp.csr_matrix, sp.csr_matrix, np.ndarray]:
        """Jacobians in the samples of q (n, N_SAMPLES n_q) and the places (n, 8), and residuals (n,)."""
        advance = self.pattern.speed * self.pattern.stride_time
        full = q.copy()
        full[:, 0] += advance * self.share
        positions, jacobians = (np.array(part) for part in self.contacts(full.T))
        jacobians = jacobians.reshape(12, N_SAMPLES, -1)  # (12, n, n_q)
        weights: list[np.ndarray] = []
        residuals: list[np.ndarray] = []
        own: list[tuple[int, int]] = []
        for k, name in enumerate(self.subject.contacts):
            side: Side = "right" if name.startswith("right") else "left"
            touches, stride = in_contact(self.pattern, side, name.partition("_")[2], self.time)
            gone = positions[3 * k : 3 * k + 3].copy()
            gone[0] -= advance * stride + places[k, 0]
            gone[1] -= places[k, 1]
            lift = self._clearance(side) - gone[2]
            for axis in range(3):
                residuals.append(np.where(touches, gone[axis] / STAYS, 0.0))
                weights.append(np.where(touches, 1 / STAYS, 0.0))
                own.append((k, axis))
            low = ~touches & (lift > 0.0)
            residuals[-1][low], weights[-1][low] = -lift[low] / LIFTS, 1 / LIFTS
        by_q = [
            sp.block_diag([weight[n] * jacobians[3 * k + axis, n][None] for n in range(N_SAMPLES)])
            for weight, (k, axis) in zip(weights, own, strict=True)
        ]
        by_place = [
            sp.csr_matrix((-weight, (np.arange(N_SAMPLES), np.full(N_SAMPLES, 2 * k + axis))), shape=(N_SAMPLES, 8))
            if axis < 2
            else sp.csr_matrix((N_SAMPLES, 8))
            for weight, (k, axis) in zip(weights, own, strict=True)
        ]
        return sp.csr_matrix(sp.vstack(by_q)), sp.csr_matrix(sp.vstack(by_place)), np.concatenate(residuals)

    def _clearance(self, side: Side) -> np.ndarray:
        period, stance = self.pattern.stride_time, self.pattern.contacts[side].stance
        own = (self.time - self.pattern.delay(side)) % period
        swing = np.clip((own - stance) / (period - stance), 0.0, 1.0)
        return self.pattern.clearance * np.sin(np.pi * swing) ** 2
