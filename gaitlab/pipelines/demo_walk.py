"""A demo walk put together: the optimal stride as simulated, the tracked reference before and after it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ..multibody.dynamics import GRAVITY
from ..multibody.subject import SubjectModel
from ..transcription.hermite import GAUSS_POINTS
from ..walking.model import POINTS
from .demo_gait import reference_gait
from .demo_optimum import OptimalStride, optimal_stride
from .demo_patterns import GaitPattern
from .demo_recording import PLATE_RATE, RATE, SimulatedWalk
from .demo_reference import recording_time, walk_events, walk_sole_changes
from .demo_simulation import ForwardDynamics, SimulatedArc, simulate_arc
from .demo_tracking import INTERVAL, TrackedRecording, track_reference

DIGITS = 7
"""Decimals of numbers in truth.json [m, rad, ...]."""


@dataclass(frozen=True, kw_only=True)
class DemoWalk:
    """A walk and what is true of it."""

    walk: SimulatedWalk
    truth: Mapping[str, Any]


def demo_walk(pattern: GaitPattern, subject: SubjectModel, weights: dict[str, float]) -> DemoWalk:
    """Simulate a walk of a subject whose right stride is optimal for known weights.

    Raises:
        NotConverged: The walk has no solution.
    """
    tracked = track_reference(reference_gait(pattern, subject))
    stride = optimal_stride(tracked, weights)
    dynamics = ForwardDynamics(tracked.walk.stride.subject)
    arcs = [simulate_arc(dynamics, arc) for arc in stride.arcs]
    walk = _joined(tracked, stride, arcs)
    return DemoWalk(walk=walk, truth=_truth(tracked, stride, arcs, walk))


def _joined(tracked: TrackedRecording, stride: OptimalStride, arcs: list[SimulatedArc]) -> SimulatedWalk:
    subject, n_q = tracked.walk.stride.subject, tracked.walk.stride.n_q
    dense = recording_time(tracked.pattern, PLATE_RATE) - tracked.start
    times, states = tracked.walk.stride.times, tracked.walk.states
    q = CubicHermiteSpline(times, states[:, :n_q], states[:, n_q:])(dense)
    scaled = tracked.walk.problem.points(tracked.walk.solution.w)[:, 3 * n_q :]
    at = (times[:-1, None] + np.diff(times)[:, None] * GAUSS_POINTS).ravel()
    forces = np.stack([np.interp(dense, at, column) for column in scaled.T], axis=1) * subject.mass * GRAVITY
    per_node = round(INTERVAL * PLATE_RATE)
    for arc, simulated in zip(stride.arcs, arcs, strict=True):
        part = slice(per_node * arc.first, per_node * arc.first + len(simulated.q))
        q[part], forces[part] = simulated.q, simulated.forces.reshape(-1, 3 * len(POINTS))
    return SimulatedWalk(
        subject=subject,
        q=q[:: round(PLATE_RATE / RATE)],
        dense_q=q,
        forces={name: forces[:, 3 * i : 3 * i + 3] for i, name in enumerate(POINTS)},
        events=walk_events(tracked.pattern),
        sole_changes=walk_sole_changes(tracked.pattern),
    )


def _truth(
    tracked: TrackedRecording, stride: OptimalStride, arcs: list[SimulatedArc], walk: SimulatedWalk
) -> dict[str, Any]:
    first, last = tracked.stride_nodes
    settings, times = stride.settings, tracked.walk.stride.times
    return {
        "stride_time_s": tracked.pattern.stride_time,
        "speed_m_per_s": tracked.pattern.speed,
        "optimal_stride_s": [round(times[first], DIGITS), round(times[last], DIGITS)],
        "criteria": list(stride.criteria),
        "weights": [float(weight) for weight in stride.weights],
        "normalisers": [float(value) for value in stride.normalisers],
        "raw_weights": [float(value) for value in stride.weights / stride.normalisers],
        "floors": {
            "torque": settings.torque_floor,
            "acceleration": settings.smoothness_floor,
            "force": settings.force_weight,
            "acceleration_normaliser": stride.accelerations,
        },
        "stages": [
            {"label": stage.label, "duration_s": round(stage.duration, DIGITS)} for stage in tracked.walk.stride.stages
        ],
        "arcs": [{"start_s": round(times[arc.first], DIGITS), "state": _rounded(arc.states[0])} for arc in stride.arcs],
        "end_state": _rounded(stride.arcs[-1].states[-1]),
        "certificate": {
            "interval_s": INTERVAL,
            "kkt_residual": max(arc.solution.residuals.max() for arc in stride.arcs),
            "relative_change_of_acceleration_floor": stride.change,
            "largest_defect_of_simulation": max(arc.defect for arc in arcs),
            "barrier": max(arc.solution.mu for arc in stride.arcs),
            "rms_optimal_from_tracked": _distance(tracked, stride),
        },
        "rate_hz": RATE,
        "q": _rounded(walk.q),
    }


def _distance(tracked: TrackedRecording, stride: OptimalStride) -> float:
    """Root mean square difference of the coordinates at the nodes within arcs [m, rad]."""
    n_q = tracked.walk.stride.n_q
    squares = [
        (arc.states - tracked.walk.states[arc.first : arc.first + len(arc.states)])[1:-1, :n_q] ** 2
        for arc in stride.arcs
    ]
    return float(np.sqrt(np.mean(np.concatenate(squares))))


def _rounded(values: np.ndarray) -> Any:
    return (np.round(values, DIGITS) + 0.0).tolist()
