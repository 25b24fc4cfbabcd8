r"""Makes the data of the gait benchmark: given states, true weights, and the true motion by another integrator.

1. A kinematic gait of textbook curves on the thesis's bodies, standing on one toe at a time.
2. Each single support is tracked from a given state, the end free but at the floor; at its end the velocities jump by
   the law of a rigid inelastic impact, M (v+ - v-) = J' Lambda, J v+ = 0, and the next support begins there.
   So the given states are within reach of moderate torques.
3. Criteria are normalised by their values on that motion; the thesis's weights, its scalings and these numbers give the
   true weights on the simplex.
4. The optimal motion for them is found by continuation on the estimator's grid, then on a grid twice as fine.
5. From every node of the estimator's grid, the fine grid's torques drive the body through an adaptive Runge-Kutta
   method of order 8; where it arrives is what is measured.
"""

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ..errors import NotConverged
from ..multibody.dynamics import contact_velocities, inverse_dynamics, layout_of, parameter_vector
from ..multibody.subject import SubjectModel
from ..nlp.interior_point import InteriorPoint
from ..nlp.sparse_solution import Status
from ..ocp.mechanical import ContactStage
from ..transcription.contact_rank import without_redundant_contacts
from ..transcription.hermite import GAUSS_POINTS
from ..transcription.mechanical_layout import Boundary, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure
from ..walking.criteria import ALL, THESIS
from ..walking.gait_data import MeasuredGait, PointFootGait
from ..walking.model import POINTS, ROOT, walking_functions
from ..walking.point_foot_gait import GaitLevel, GaitOptimum
from ..walking.tracking import N_FORCES
from .demo_gait import ReferenceGait, reference_gait
from .demo_patterns import ContactTimes
from .demo_simulation import Contact, ForwardDynamics, integrate, torques_at_nodes
from .gait_cases import CASES, GaitCase, ThesisGait

INTERVAL = 0.0125
"""Of the grid on which the kinematic gait is tracked [s]."""
TRACKING_TORQUE, TRACKING_ACCELERATION = 1e-5, 1e-6
"""Weights of squared torques and accelerations beside squared tracking errors [rad]."""
ENDS = 50.0
"""Factor on the tracking of velocities at the ends of a stage, which keeps landings slow."""
TORQUE_FLOOR, FORCE_WEIGHT = 0.01, 1e-4
"""The floors of `walking.identification`."""
FLOOR_OF_STAGE = ((3 * POINTS.index("left_toe") + 2,), (3 * POINTS.index("right_toe") + 2,), ())
"""Heights that are zero at the end of each stage."""
LANDING = ("left_toe", "right_toe")


@dataclass(frozen=True, kw_only=True)
class _Start:
    """Motion that the continuation starts from."""

    states: tuple[np.ndarray, ...]
    """At the nodes of each stage, shapes (N_k + 1, 2 n_q)."""


def make_case(thesis: ThesisGait) -> GaitCase:
    """Everything about one model. Raises `errors.NotConverged` where a step of the recipe fails."""
    start = _tracked(thesis, _reference(thesis))
    ends = np.array([[states[0], states[-1]] for states in start.states])
    plain = _gait(thesis, ends, np.ones(len(THESIS)), 0.0)
    on_track = _as_optimum(plain, start)
    normalisers, accelerations = on_track.criteria(), on_track.squares(2 * plain.subject.n_q + 3, 3 * plain.subject.n_q)
    raw = thesis.weights * thesis.scalings * normalisers
    weights = raw / raw.sum()
    gait = _gait(thesis, ends, normalisers, 2.0 * thesis.smoothness / accelerations)
    optimum = _optimum(gait, start, weights)
    fine = _refined(gait, optimum, weights)
    return GaitCase(
        thesis=thesis,
        gait=gait,
        weights=weights,
        q=_simulated(gait, fine),
        certificate={
            "largest_residual": fine.solution.residuals.max(),
            "rms_between_grids_rad": _difference(optimum, fine),
            "largest_torque_Nm": fine.largest_torque(),
        },
    )


def _reference(thesis: ThesisGait) -> ReferenceGait:
    """Kinematic gait whose stages last as long as the thesis's; time 0 is the right foot strike."""
    first, second, third = thesis.durations
    period = first + second + third
    contacts = {
        "right": ContactTimes(heel=(0.0, 0.0), toe=(0.0, first + third)),
        "left": ContactTimes(heel=(0.0, 0.0), toe=(first + third - period / 2, period / 2)),
    }
    pattern = replace(thesis.pattern(), stride_time=period, speed=thesis.speed, contacts=contacts)
    return reference_gait(pattern, thesis.subject())


def _gait(thesis: ThesisGait, ends: np.ndarray, normalisers: np.ndarray, acceleration_weight: float) -> PointFootGait:
    return PointFootGait(
        name=thesis.name,
        subject=thesis.subject(),
        durations=thesis.durations,
        n_intervals=thesis.n_intervals,
        states=ends,
        normalisers=normalisers,
        acceleration_weight=acceleration_weight,
        torque_floor=TORQUE_FLOOR if acceleration_weight else 0.0,
        force_weight=FORCE_WEIGHT,
    )


def _tracked(thesis: ThesisGait, reference: ReferenceGait) -> _Start:
    """The stages one after another, each from where the impact before left the body."""
    subject = in_order(thesis.subject())
    found, start, begin = list[np.ndarray](), None, thesis.durations[2]
    coarse = replace(thesis, n_intervals=tuple(max(5, round(d / INTERVAL)) for d in thesis.durations))
    plain = _gait(coarse, np.zeros((3, 2, 2 * subject.n_q)), np.ones(len(THESIS)), 0.0)
    for k, stage in enumerate(plain.stages):
        times = begin + np.linspace(0.0, stage.duration, stage.n_intervals + 1)
        states = np.hstack([reference.coordinates(times, order) for order in (0, 1)])
        found.append(_tracked_stage(subject, (stage, FLOOR_OF_STAGE[k]), states, start))
        begin += stage.duration
        if k < len(LANDING):
            start = after_impact(subject, found[-1][-1], LANDING[k])
    shift = found[0][0, 0]
    for states in found:
        states[:, 0] -= shift
    parts = zip(found, thesis.durations, thesis.n_intervals, strict=True)
    return _Start(states=tuple(_between(x, duration, n) for x, duration, n in parts))


def _between(states: np.ndarray, duration: float, n: int) -> np.ndarray:
    """States (m + 1, 2 n_q) of a stage at n + 1 nodes instead, by its cubic splines."""
    n_q = states.shape[1] // 2
    spline = CubicHermiteSpline(np.linspace(0.0, duration, len(states)), states[:, :n_q], states[:, n_q:])
    times = np.linspace(0.0, duration, n + 1)
    return np.hstack([spline(times), spline(times, 1)])


def in_order(subject: SubjectModel) -> SubjectModel:
    """The subject with contact points in the order of the force components."""
    return replace(subject, contacts={name: subject.contacts[name] for name in POINTS})


def _tracked_stage(
    subject: SubjectModel, stage: tuple[ContactStage, tuple[int, ...]], reference: np.ndarray, start: np.ndarray | None
) -> np.ndarray:
    """States (N + 1, 2 n_q) near a reference of that shape, from a given state (2 n_q,) where there is one."""
    n_q = subject.n_q
    functions, p = walking_functions(layout_of(subject)).functions, _parameters(subject)
    given = reference.copy()
    boundary = Boundary()
    if start is not None:
        given[0], boundary = start, Boundary(((0, tuple(range(2 * n_q))),))
    layout = MechanicalLayout((stage[0],), n_q, N_FORCES, ROOT, boundary, touching_end=stage[1])
    structure = MechanicalStructure(without_redundant_contacts(layout, functions, p, given), functions)
    tracking = np.tile(np.concatenate([np.ones(n_q), np.full(n_q, 0.01)]), (len(reference), 1))
    tracking[:, [0, 1, 2, n_q, n_q + 1, n_q + 2]] *= 4.0
    tracking[[0, -1], n_q:] *= ENDS
    theta = np.zeros(len(ALL))
    theta[list(ALL).index("torque")] = TRACKING_TORQUE / stage[0].duration
    data = MechanicalData(
        p=p,
        theta=theta,
        reference=reference,
        tracking=tracking,
        given=given,
        lower=np.full(n_q, -np.inf),
        upper=np.full(n_q, np.inf),
        acceleration_weights=TRACKING_ACCELERATION * (np.arange(n_q) > 2),
        force_weight=FORCE_WEIGHT,
    )
    problem = MechanicalProblem(structure, data)
    w = np.zeros(structure.n_w)
    w[: given.size] = given.ravel()
    vertical = structure.force_index[:, 2::3]
    w[vertical[vertical >= 0]] = 1.0
    solution = InteriorPoint(mu_final=1e-7).solve(problem, w)
    if solution.status is not Status.SOLVED:
        raise NotConverged(f"stage {stage[0].label} could not be tracked: {solution.status}")
    return problem.states(solution.w)


def _parameters(subject: SubjectModel) -> np.ndarray:
    return np.concatenate([parameter_vector(subject), np.zeros(3 * (subject.n_q - ROOT))])


def after_impact(subject: SubjectModel, state: np.ndarray, point: str) -> np.ndarray:
    """State [m, rad, 1/s] after a rigid inelastic impact of a contact point, from that before, both shape (2 n_q,)."""
    layout, n_q = layout_of(subject), subject.n_q
    p = ca.SX(parameter_vector(subject))
    q, v, a = (ca.SX.sym(name, n_q) for name in "qva")
    mass = ca.jacobian(ca.substitute(inverse_dynamics(layout, p, q, v, a, {}), v, ca.SX.zeros(n_q)), a)
    rate = ca.jacobian(contact_velocities(layout, p, q, v)[point], v)
    M, J = (np.array(x) for x in ca.Function("impact", [q], [ca.densify(mass), ca.densify(rate)])(state[:n_q]))
    system = np.block([[M, -J.T], [J, np.zeros((3, 3))]])
    after = np.linalg.solve(system, np.concatenate([M @ state[n_q:], np.zeros(3)]))
    return np.concatenate([state[:n_q], after[:n_q]])


def _as_optimum(gait: PointFootGait, start: _Start) -> GaitOptimum:
    """The motion itself in the form of an optimum, to ask for its criteria."""
    return _level(gait, start.states).at_start(np.zeros(len(THESIS)))


def _level(gait: PointFootGait, states: tuple[np.ndarray, ...]) -> GaitLevel:
    n_q = gait.subject.n_q
    measured = MeasuredGait(q=tuple(x[:, :n_q] for x in states), deviation=np.full(n_q, np.radians(1.0)))
    return GaitLevel(gait, measured, first=states)


def _optimum(gait: PointFootGait, start: _Start, weights: np.ndarray) -> GaitOptimum:
    found = _level(gait, start.states).from_measurements(weights)
    if found.solution.status is not Status.SOLVED:
        raise NotConverged(f"{gait.name}: the true weights have no optimal gait: {found.solution.status}")
    return found


def _refined(gait: PointFootGait, optimum: GaitOptimum, weights: np.ndarray) -> GaitOptimum:
    """The optimum on a grid twice as fine."""
    fine = gait.finer(2)
    parts = zip(optimum.states, fine.durations, fine.n_intervals, strict=True)
    states = tuple(_between(x, duration, n) for x, duration, n in parts)
    found = _level(fine, states).from_forces(weights, _forces_between(optimum, 2))
    if found.solution.status is not Status.SOLVED:
        raise NotConverged(f"{gait.name}: no optimal gait on the finer grid: {found.solution.status}")
    return found


def _forces_between(optimum: GaitOptimum, factor: int) -> list[np.ndarray]:
    """Forces of the floor at the Gauss points of a finer grid, per stage (2 factor N_k, n_f)."""
    found, n_q = list[np.ndarray](), optimum.level.n_q
    for problem, x, n in zip(optimum.problems, optimum.solutions, optimum.level.gait.n_intervals, strict=True):
        forces = problem.points(x.w)[:, 3 * n_q :]
        times = [((np.arange(m)[:, None] + GAUSS_POINTS) / m).ravel() for m in (n, factor * n)]
        found.append(np.stack([np.interp(times[1], times[0], force) for force in forces.T], axis=1))
    return found


def _difference(coarse: GaitOptimum, fine: GaitOptimum) -> float:
    """Root mean square difference of the coordinates at the coarse nodes [m, rad]."""
    n_q = coarse.level.n_q
    gaps = [(a - b[::2])[:, :n_q] for a, b in zip(coarse.states, fine.states, strict=True)]
    return float(np.sqrt(np.mean(np.concatenate(gaps) ** 2)))


def _simulated(gait: PointFootGait, fine: GaitOptimum) -> tuple[np.ndarray, ...]:
    """Coordinates at the estimator's nodes, each simulated from the node before; shapes (N_k + 1, n_q)."""
    n_q, dynamics = gait.subject.n_q, ForwardDynamics(in_order(gait.subject))
    found = list[np.ndarray]()
    for stage, problem, x in zip(fine.level.gait.stages, fine.problems, fine.solutions, strict=True):
        states, torques = problem.states(x.w), torques_at_nodes(problem, x.w)
        h, active = stage.duration / stage.n_intervals, list(stage.active)
        contact, q = Contact(active=active, held=dynamics.places(states[0, :n_q])), [states[0, :n_q]]
        for node in range(0, stage.n_intervals, 2):
            state = states[node]
            for k in (node, node + 1):
                state = integrate(dynamics, contact, state, torques[k], np.array([0.0, h]))[0][-1]
            q.append(state[:n_q])
        found.append(np.array(q))
    return tuple(found)


def make_all() -> list[GaitCase]:
    """Both models."""
    return [make_case(thesis) for thesis in CASES.values()]
