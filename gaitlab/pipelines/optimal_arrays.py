"""The tracked and the optimal walk at the stored frames, laboratory frame, for `walk.npz`."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ..multibody.dynamics import GRAVITY
from ..multibody.kinematics import point_positions
from ..multibody.subject import SubjectModel
from ..transcription.hermite import GAUSS_POINTS
from ..transcription.mechanical_problem import MechanicalProblem
from ..walking.criteria import positions
from ..walking.explanation import Explanation
from ..walking.model import POINTS, ROOT
from .gait_frame import gait_to_lab
from .walk_arrays import skeleton


@dataclass(frozen=True, kw_only=True)
class ModelledStride:
    """A stride of the model in time."""

    subject: SubjectModel
    times: np.ndarray
    """Of the nodes [s], shape (N + 1,)."""
    floor: float
    """Height [m] that was taken from the pelvis."""
    problem: MechanicalProblem
    w: np.ndarray
    """Variables, shape (n_w,)."""
    criteria: tuple[str, ...]

    def coordinates(self, states: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Coordinates (n, n_q) at times (n,) [s] by the cubics of the collocation from states (N + 1, 2 n_q).

        On the measured floor [m, rad].
        """
        n_q = self.subject.n_q
        q = CubicHermiteSpline(self.times, states[:, :n_q], states[:, n_q:])(time)
        q[:, 2] += self.floor
        return q

    def between_points(self, values: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Values at the Gauss points, shape (2 N, k), any unit, interpolated at times (n,) [s]: shape (n, k)."""
        at = (self.times[:-1, None] + np.diff(self.times)[:, None] * GAUSS_POINTS).ravel()
        return np.stack([np.interp(time, at, column) for column in values.T], axis=1)

    def forces(self) -> np.ndarray:
        """Of the floor on `POINTS` at the Gauss points, gait frame [N], shape (2 N, 12)."""
        return self.problem.points(self.w)[:, 3 * self.subject.n_q :] * self.subject.mass * GRAVITY

    def shares(self) -> np.ndarray:
        """Parts of the weighted criteria at the Gauss points, shape (2 N, n_criteria)."""
        columns = positions(self.criteria)
        cost = (self.problem.running_criteria(self.w) * self.problem.data.theta)[:, columns]
        return cost / np.maximum(cost.sum(axis=1, keepdims=True), np.finfo(float).tiny)


def optimal_arrays(found: Explanation, n_frames: int, rate: float, heading: float) -> dict[str, np.ndarray]:
    """Arrays of `modelled_arrays` and q_tracked with one row per stored frame, NaN outside the stride.

    Args:
        found: Result of the stride.
        n_frames: Stored frames.
        rate: Frames per second [Hz].
        heading: Direction of the gait frame in the laboratory [rad].
    """
    stride = found.tracked.stride
    model = ModelledStride(
        subject=stride.subject,
        times=stride.times,
        floor=stride.floor,
        problem=found.optimum.problem,
        w=found.optimum.solution.w,
        criteria=found.level.settings.criteria,
    )
    time = np.arange(n_frames) / rate
    return modelled_arrays(model, time, heading, {"q_tracked": found.tracked.states})


def modelled_arrays(
    model: ModelledStride, time: np.ndarray, heading: float, others: dict[str, np.ndarray] | None = None
) -> dict[str, np.ndarray]:
    """Arrays with one row per time [s] of shape (n,), NaN outside the stride.

    q_optimal (n, n_q) in the gait frame; tau_optimal (n, n_q - 6) [N*m]; forces_optimal and contact_positions_optimal
    (n, n_contacts, 3) [N, m] and segment_positions_optimal in the laboratory frame; criteria_share (n, n_criteria),
    parts of the weighted criteria at each instant; and coordinates from other states (N + 1, 2 n_q) under their names.
    """
    inside = (time >= model.times[0] - 1e-9) & (time <= model.times[-1] + 1e-9)
    clipped = np.clip(time[inside], model.times[0], model.times[-1])
    subject, problem = model.subject, model.problem
    q_optimal = model.coordinates(problem.states(model.w), clipped)
    contacts = [POINTS.index(name) for name in subject.contacts]
    forces = model.between_points(model.forces(), clipped).reshape(-1, len(POINTS), 3)[:, contacts]
    positions = point_positions(subject, subject.contacts, q_optimal)
    columns = np.stack([positions[name] for name in subject.contacts], axis=1)
    rows = {name: model.coordinates(states, clipped) for name, states in (others or {}).items()} | {
        "q_optimal": q_optimal,
        "tau_optimal": model.between_points(problem.outputs(model.w)[:, ROOT : subject.n_q], clipped),
        "forces_optimal": gait_to_lab(forces, heading),
        "contact_positions_optimal": gait_to_lab(columns, heading),
        "segment_positions_optimal": skeleton(subject, q_optimal, heading),
        "criteria_share": model.between_points(model.shares(), clipped),
    }
    return {name: spread(values, inside) for name, values in rows.items()} | {
        "criteria_names": np.array(model.criteria),
        "contact_names": np.array(list(subject.contacts)),
    }


def spread(values: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Values (n_inside, ...), any unit, at the rows that are inside, shape (n,), NaN elsewhere: shape (n, ...)."""
    full = np.full((len(inside), *values.shape[1:]), np.nan)
    full[inside] = values
    return full
