"""The optimal control problem with known weights behind a demo recording, solved arc by arc on the fine grid.

All states are given at the boundaries of arcs (see `walking.identification`), so the problem falls apart into arcs that
share only the weights. The weights are chosen for criteria divided by their values N_i on the tracked stride. The
estimator divides by their values N'_i on the recorded, the optimal stride. The same problem has there the weights of
`WalkLevel.restated`, provided that the floor of accelerations is divided by k times their value on the optimal stride:
a fixed point in one number.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..errors import NotConverged, ProblemError
from ..multibody.dynamics import layout_of
from ..nlp.sparse_solution import SparseSolution, Status
from ..ocp.mechanical import ContactStage
from ..transcription.contact_rank import without_redundant_contacts
from ..transcription.mechanical_layout import Boundary, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure
from ..walking.arcs import part_of_stages
from ..walking.identification import IdentificationSettings, WalkLevel, arc_boundaries
from ..walking.model import ROOT, walking_functions
from ..walking.tracking import N_FORCES
from .demo_patterns import GRID
from .demo_tracking import TrackedRecording, pattern_stages

REPETITIONS, CHANGE = 20, 1e-4
"""Repetitions at most for the floor of accelerations, until it changes by no more than this share."""
NEARBY = 0.1
"""Factor on the weights of tracking on the way from the tracked walk to no tracking."""


@dataclass(frozen=True, kw_only=True)
class OptimalArc:
    """One arc between given states."""

    first: int
    """Node of the recording where it begins."""
    stages: tuple[ContactStage, ...]
    problem: MechanicalProblem
    solution: SparseSolution

    @property
    def states(self) -> np.ndarray:
        """States at the nodes [m, rad, 1/s], shape (n + 1, 2 n_q)."""
        return self.problem.states(self.solution.w)


@dataclass(frozen=True, kw_only=True)
class OptimalStride:
    """The optimal right stride of a recording."""

    arcs: tuple[OptimalArc, ...]
    criteria: tuple[str, ...]
    weights: np.ndarray
    """True weights on the simplex, for criteria divided by `normalisers`, shape (n_criteria,)."""
    normalisers: np.ndarray
    """Integrals of the criteria over the optimal stride, shape (n_criteria,)."""
    accelerations: float
    """Number that divides the squared accelerations in their floor, for the true weights [1/s^3]."""
    change: float
    """Relative change of that number in the last repetition."""
    settings: IdentificationSettings


def optimal_stride(tracked: TrackedRecording, weights: dict[str, float]) -> OptimalStride:
    """Solve the arcs of the right stride for known weights.

    Args:
        tracked: The tracked recording.
        weights: Criterion, "torque" among them, to its weight in units of the tracked stride.

    Raises:
        NotConverged: An arc has no certified solution.
        ProblemError: The estimator's grid would put the given states elsewhere.
    """
    settings = IdentificationSettings(criteria=tuple(weights))
    theta = np.array(list(weights.values()))
    level = WalkLevel(tracked.walk, settings)
    bounds = _bounds(tracked, settings)
    level.all_normalisers, level.acceleration_normaliser = _stride_of_tracking(level, tracked)
    level.normalisers = level.all_normalisers[level.indices]
    arcs = [_first(tracked, level.problem(theta).data, a, b) for a, b in zip(bounds[:-1], bounds[1:], strict=True)]
    change = np.inf
    for _ in range(REPETITIONS):
        criteria, accelerations = _stride_of_arcs(level, arcs)
        scale = level.restated(theta, criteria)[1]
        change = abs(scale * accelerations / level.acceleration_normaliser - 1.0)
        if change < CHANGE:
            break
        level.acceleration_normaliser = scale * accelerations
        data = level.problem(theta).data
        arcs = [_again(arc, data, settings) for arc in arcs]
    criteria = _stride_of_arcs(level, arcs)[0]
    true_weights, scale = level.restated(theta, criteria)
    return OptimalStride(
        arcs=tuple(arcs),
        criteria=settings.criteria,
        weights=true_weights,
        normalisers=criteria[level.indices],
        accelerations=level.acceleration_normaliser / scale,
        change=float(change),
        settings=settings,
    )


def _bounds(tracked: TrackedRecording, settings: IdentificationSettings) -> np.ndarray:
    """Nodes of the recording with given states, first to last of the right stride, shape (n_arcs + 1,)."""
    fine = arc_boundaries(tracked.walk.stride.stages, settings.longest_arc)
    coarse = arc_boundaries(pattern_stages(tracked.pattern, GRID), settings.longest_arc)
    if not np.array_equal(fine, 2 * coarse):
        raise ProblemError(f"{tracked.pattern.name}: arcs must begin on the estimator's grid of {GRID} s")
    first, last = tracked.stride_nodes
    return fine[(fine >= first) & (fine <= last)]


def _stride_of_tracking(level: WalkLevel, tracked: TrackedRecording) -> tuple[np.ndarray, float]:
    """Integrals of all criteria and of squared accelerations over the tracked right stride."""
    problem, w = tracked.walk.problem, tracked.walk.solution.w
    first, last = tracked.stride_nodes
    points = slice(2 * first, 2 * last)
    weights = problem.shared.weights[points]
    n_q = tracked.walk.stride.n_q
    a = problem.points(w)[points, 2 * n_q : 3 * n_q]
    return weights @ problem.running_criteria(w)[points], float(weights @ (a**2 @ level.smooth))


def _stride_of_arcs(level: WalkLevel, arcs: list[OptimalArc]) -> tuple[np.ndarray, float]:
    criteria, accelerations = 0.0, 0.0
    for arc in arcs:
        w, n_q = arc.solution.w, arc.problem.shared.layout.n_q
        a = arc.problem.points(w)[:, 2 * n_q : 3 * n_q]
        criteria = criteria + arc.problem.criteria(w)
        accelerations += float(arc.problem.shared.weights @ (a**2 @ level.smooth))
    return np.asarray(criteria), accelerations


def _first(tracked: TrackedRecording, data: MechanicalData, first: int, last: int) -> OptimalArc:
    """The arc between two nodes, from the tracked walk."""
    walk, n = tracked.walk, int(last - first)
    subject, states = walk.stride.subject, walk.states[first : last + 1]
    functions = walking_functions(layout_of(subject)).functions
    stages = part_of_stages(walk.stride.stages, first, last)
    every = tuple(range(states.shape[1]))
    layout = MechanicalLayout(stages, subject.n_q, N_FORCES, ROOT, Boundary(((0, every), (n, every))))
    layout = without_redundant_contacts(layout, functions, data.p, states)
    structure = MechanicalStructure(layout, functions)
    start = np.zeros(structure.n_w)
    start[: states.size] = states.ravel()
    used = structure.force_index >= 0
    forces = walk.problem.points(walk.solution.w)[2 * first : 2 * last, 3 * subject.n_q :]
    start[structure.force_index[used]] = forces[used]
    data = replace(data, given=states, reference=states)
    weights = walk.problem.data.tracking[first : last + 1]
    solver = replace(IdentificationSettings().solver, mu_initial=1e-4, max_iter=500)
    near = MechanicalProblem(structure, replace(data, tracking=NEARBY * weights))
    problem = MechanicalProblem(structure, replace(data, tracking=0.0 * weights))
    solution = solver.solve(problem, solver.solve(near, start))
    return _solved(OptimalArc(first=first, stages=stages, problem=problem, solution=solution))


def _again(arc: OptimalArc, data: MechanicalData, settings: IdentificationSettings) -> OptimalArc:
    """The arc with other weights, from its solution."""
    data = replace(data, given=arc.problem.data.given, reference=arc.problem.data.reference, tracking=0 * arc.states)
    problem = MechanicalProblem(arc.problem.shared, data)
    return _solved(replace(arc, problem=problem, solution=settings.solver.solve(problem, arc.solution)))


def _solved(arc: OptimalArc) -> OptimalArc:
    if arc.solution.status is not Status.SOLVED:
        raise NotConverged(f"the demo arc from node {arc.first} was not solved: {arc.solution.status}")
    return arc
