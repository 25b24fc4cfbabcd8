"""The tracked and the optimal walk at the stored frames, laboratory frame, for `walk.npz`."""

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ..multibody.dynamics import GRAVITY
from ..multibody.kinematics import point_positions
from ..transcription.hermite import GAUSS_POINTS
from ..walking.criteria import ALL
from ..walking.explanation import Explanation
from ..walking.model import POINTS, ROOT
from .gait_frame import gait_to_lab
from .walk_arrays import skeleton


def optimal_arrays(found: Explanation, n_frames: int, rate: float, heading: float) -> dict[str, np.ndarray]:
    """Arrays with one row per stored frame, NaN outside the stride.

    q_tracked and q_optimal (n, n_q) in the gait frame; tau_optimal (n, n_q - 6) [N*m]; forces_optimal and
    contact_positions_optimal (n, n_contacts, 3) [N, m] and segment_positions_optimal in the laboratory frame;
    criteria_share (n, n_criteria), parts of the weighted criteria at each instant.

    Args:
        found: Result of the stride.
        n_frames: Stored frames.
        rate: Frames per second [Hz].
        heading: Direction of the gait frame in the laboratory [rad].
    """
    stride = found.tracked.stride
    time = np.arange(n_frames) / rate
    inside = (time >= stride.times[0] - 1e-9) & (time <= stride.times[-1] + 1e-9)
    clipped = np.clip(time[inside], stride.times[0], stride.times[-1])
    q_optimal = _at(found, found.optimum.problem.states(found.optimum.solution.w), clipped)
    problem, w = found.optimum.problem, found.optimum.solution.w
    gauss = _gauss_times(found)
    forces = problem.points(w)[:, 3 * stride.n_q :] * stride.subject.mass * GRAVITY
    contacts = [POINTS.index(name) for name in stride.subject.contacts]
    world_forces = gait_to_lab(_interpolate(clipped, gauss, forces).reshape(-1, len(POINTS), 3)[:, contacts], heading)
    positions = point_positions(stride.subject, stride.subject.contacts, q_optimal)
    columns = np.stack([positions[name] for name in stride.subject.contacts], axis=1)
    rows = {
        "q_tracked": _at(found, found.tracked.states, clipped),
        "q_optimal": q_optimal,
        "tau_optimal": _interpolate(clipped, gauss, problem.outputs(w)[:, ROOT : stride.n_q]),
        "forces_optimal": world_forces,
        "contact_positions_optimal": gait_to_lab(columns, heading),
        "segment_positions_optimal": skeleton(stride.subject, q_optimal, heading),
        "criteria_share": _interpolate(clipped, gauss, _shares(found)),
    }
    return {name: _spread(values, inside) for name, values in rows.items()} | {
        "criteria_names": np.array(found.level.settings.criteria),
        "contact_names": np.array(list(stride.subject.contacts)),
    }


def _at(found: Explanation, states: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Coordinates between the nodes by the cubics of the collocation, on the measured floor."""
    stride = found.tracked.stride
    q = CubicHermiteSpline(stride.times, states[:, : stride.n_q], states[:, stride.n_q :])(time)
    q[:, 2] += stride.floor
    return q


def _gauss_times(found: Explanation) -> np.ndarray:
    times = found.tracked.stride.times
    return (times[:-1, None] + np.diff(times)[:, None] * GAUSS_POINTS).ravel()


def _shares(found: Explanation) -> np.ndarray:
    names = list(ALL)
    columns = [names.index(name) for name in found.level.settings.criteria]
    cost = found.optimum.problem.running_criteria(found.optimum.solution.w)[:, columns]
    cost = cost * found.estimate.theta / found.level.normalisers
    return cost / np.maximum(cost.sum(axis=1, keepdims=True), np.finfo(float).tiny)


def _interpolate(time: np.ndarray, at: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.stack([np.interp(time, at, column) for column in values.T], axis=1)


def _spread(values: np.ndarray, inside: np.ndarray) -> np.ndarray:
    full = np.full((len(inside), *values.shape[1:]), np.nan)
    full[inside] = values
    return full
