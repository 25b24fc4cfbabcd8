"""The dynamically consistent walk that lies closest to a measured stride."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.interpolate import CubicSpline

from ..errors import InvalidRecording
from ..multibody.dynamics import layout_of, parameter_vector
from ..multibody.kinematics import point_positions
from ..multibody.subject import PointOnSegment, SubjectModel
from ..nlp.interior_point import InteriorPoint
from ..nlp.sparse_solution import SparseSolution
from ..ocp.mechanical import ContactStage
from ..transcription.mechanical_layout import Boundary, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure
from .criteria import ALL
from .model import POINTS, ROOT, walking_functions

N_FORCES = 12
SolverProgress = Callable[[int, float], None]


@dataclass(frozen=True, kw_only=True)
class TrackingSettings:
    """What the tracking problem weighs; the units make the terms comparable."""

    velocity_weight: float = 0.01
    """Weight of a velocity error of 1 rad/s beside an angle error of 1 rad: it keeps the nodes from ringing."""
    translation_weight: float = 4.0
    """Weight of a pelvis error of 1 m beside an angle error of 1 rad: 5 mm count as 10 mrad."""
    torque_weight: float = 3e-5
    """Weight of the integral of squared torques [1 / (N*m)^2 s]: small beside the tracking error, it smooths."""
    force_weight: float = 1e-4
    """Weight of squared contact forces in body weights: makes the split between heel and toe unique."""
    allowance: float = 0.02
    """How far [m] free heels and toes may sink below the floor: markers sit on skin and shoes, not on the sole."""
    solver: InteriorPoint = field(
        default_factory=lambda: InteriorPoint(tol=1e-8, mu_initial=1e-2, mu_final=1e-8, max_iter=300)
    )


@dataclass(frozen=True, kw_only=True)
class MeasuredStride:
    """A stride to explain: who, which contacts, which motion."""

    subject: SubjectModel
    stages: tuple[ContactStage, ...]
    times: np.ndarray
    """Times of the nodes [s] from the first stored frame, shape (N + 1,)."""
    reference: np.ndarray
    """Measured states (q, v) at the nodes, gait frame, shape (N + 1, 2 n_q)."""
    floor: float = 0.0
    """Height [m] that was taken from the pelvis so that planted points stand at zero."""

    @property
    def n_q(self) -> int:
        """Number of coordinates."""
        return self.subject.n_q


@dataclass(frozen=True, kw_only=True)
class TrackedWalk:
    """Solution of the tracking problem."""

    stride: MeasuredStride
    problem: MechanicalProblem
    solution: SparseSolution

    @property
    def states(self) -> np.ndarray:
        """States at the nodes, shape (N + 1, 2 n_q)."""
        return self.problem.states(self.solution.w)

    @property
    def rms(self) -> float:
        """Root mean square tracking error of all coordinates [rad, m]."""
        error = (self.states - self.stride.reference)[:, : self.stride.n_q]
        return float(np.sqrt(np.mean(error**2)))


def measured_stride(
    subject: SubjectModel, stages: tuple[ContactStage, ...], start: float, q: np.ndarray, rate: float
) -> MeasuredStride:
    """Sample measured coordinates q, shape (n_frames, n_q), at the nodes of the stages that begin at `start` [s].

    The pelvis is shifted vertically so that the planted contact points stand on the floor on average. Raises
    `errors.InvalidRecording` where coordinates are missing within the stride.
    """
    subject = _in_order(subject)
    lengths = np.concatenate([np.full(s.n_intervals, s.duration / s.n_intervals) for s in stages])
    times = start + np.concatenate([[0.0], np.cumsum(lengths)])
    frames = np.arange(len(q)) / rate
    known = np.all(np.isfinite(q), axis=1)
    inside = (frames >= times[0] - 1e-9) & (frames <= times[-1] + 1e-9)
    if not np.all(known[inside]) or frames[known][0] > times[0] + 1e-9 or frames[known][-1] < times[-1] - 1e-9:
        raise InvalidRecording(
            f"markers are missing within the stride from {times[0]:.2f} s to {times[-1]:.2f} s; choose another stride"
        )
    spline = CubicSpline(frames[known], q[known])
    reference = np.hstack([spline(times), spline(times, 1)])
    floor = _stance_height(subject, stages, reference[:, : subject.n_q])
    reference[:, 2] -= floor
    return MeasuredStride(subject=subject, stages=stages, times=times, reference=reference, floor=floor)


def _stance_height(subject: SubjectModel, stages: tuple[ContactStage, ...], q: np.ndarray) -> float:
    """Mean height of the contact points while they are planted [m]."""
    heights = point_positions(subject, _contact_points(subject), q)
    planted = [heights[name][nodes, 2] for name, nodes in _planted(stages)]
    return float(np.mean(np.concatenate(planted))) if planted else 0.0


def planted_heights(subject: SubjectModel, stages: tuple[ContactStage, ...], q: np.ndarray) -> np.ndarray:
    """Mean height of the planted contact points at each node [m], shape (N + 1,), of coordinates q (N + 1, n_q).

    Where no point is planted, linear between the nodes before and after.
    """
    heights = point_positions(subject, _contact_points(subject), q)
    total, count = np.zeros(len(q)), np.zeros(len(q))
    for name, nodes in _planted(stages):
        total[nodes] += heights[name][nodes, 2]
        count[nodes] += 1.0
    known = np.flatnonzero(count)
    return np.interp(np.arange(len(q)), known, total[known] / count[known])


def _planted(stages: tuple[ContactStage, ...]) -> list[tuple[str, slice]]:
    """Contact points and the nodes at which they are planted; a node between two stages counts in both."""
    found: list[tuple[str, slice]] = []
    node = 0
    for stage in stages:
        nodes = slice(node, node + stage.n_intervals + 1)
        found += [(name, nodes) for i, name in enumerate(POINTS) if 3 * i + 2 in stage.active]
        node += stage.n_intervals
    return found


def _contact_points(subject: SubjectModel) -> dict[str, PointOnSegment]:
    return {name: subject.contacts[name] for name in POINTS}


def track(
    stride: MeasuredStride, settings: TrackingSettings | None = None, progress: SolverProgress | None = None
) -> TrackedWalk:
    """Solve the tracking problem; whether it converged is in the solution's status."""
    settings = settings or TrackingSettings()
    problem = tracking_problem(stride, settings)
    solution = settings.solver.solve(problem, first_guess(problem), progress)
    return TrackedWalk(stride=stride, problem=problem, solution=solution)


def tracking_problem(stride: MeasuredStride, settings: TrackingSettings) -> MechanicalProblem:
    """The tracking problem of a stride."""
    functions = walking_functions(layout_of(stride.subject)).functions
    layout = MechanicalLayout(stride.stages, stride.n_q, N_FORCES, ROOT, Boundary())
    return MechanicalProblem(MechanicalStructure(layout, functions), tracking_data(stride, settings))


def tracking_data(stride: MeasuredStride, settings: TrackingSettings) -> MechanicalData:
    """Data of the tracking problem."""
    n_q = stride.n_q
    weights = np.concatenate([np.ones(n_q), np.full(n_q, settings.velocity_weight)])
    weights[[0, 1, 2, n_q, n_q + 1, n_q + 2]] *= settings.translation_weight
    theta = np.zeros(len(ALL))
    theta[list(ALL).index("torque")] = settings.torque_weight
    no_springs = np.zeros(3 * (n_q - ROOT))
    return MechanicalData(
        p=np.concatenate([parameter_vector(stride.subject), no_springs]),
        theta=theta,
        reference=stride.reference,
        tracking=np.tile(weights, (len(stride.reference), 1)),
        given=stride.reference,
        lower=np.full(n_q, -np.inf),
        upper=np.full(n_q, np.inf),
        acceleration_weights=np.zeros(n_q),
        force_weight=settings.force_weight,
        allowance=settings.allowance,
    )


def _in_order(subject: SubjectModel) -> SubjectModel:
    return replace(subject, contacts=_contact_points(subject))


def first_guess(problem: MechanicalProblem) -> np.ndarray:
    """Start of the tracking: measured states, and body weight spread over the points in contact; shape (n_w,)."""
    shared = problem.shared
    w = np.zeros(shared.n_w)
    w[: problem.data.reference.size] = problem.data.reference.ravel()
    vertical = shared.force_index[:, 2::3]  # (2 N, n_points)
    share = 1.0 / np.maximum((vertical >= 0).sum(axis=1, keepdims=True), 1)
    used = vertical >= 0
    w[vertical[used]] = np.broadcast_to(share, vertical.shape)[used]
    return w
