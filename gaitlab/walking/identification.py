"""The walk as a pure optimal control problem, and the weights that explain it.

The lower level sees the durations and contacts of the stages, the state of the body at the boundaries of short arcs
(every change between stance and swing, and in between so that no arc is longer than `longest_arc` and `longest_share`
allow), and the weighted criteria. The arcs are solved one by one (`arcs`). It does not see the measured motion inside
the arcs: there is no tracking term. Two floors keep it well posed: squared torque, and squared acceleration of the
angles. Without the second one, segments with little inertia (a swinging foot, the rotation of a stretched leg about
its axis) may turn freely at almost no torque.
"""

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ..multibody.dynamics import layout_of
from ..nlp.interior_point import InteriorPoint
from ..nlp.sensitivity import Sensitivity
from ..nlp.sparse_solution import SparseSolution
from ..nlp.workers import Workers
from ..ocp.mechanical import ContactStage
from ..transcription.contact_rank import without_redundant_contacts
from ..transcription.mechanical_layout import Boundary, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalProblem, MechanicalStructure
from .arcs import Arcs, Attempt
from .criteria import ALL, THESIS, positions
from .given_states import coloured_moves
from .model import ROOT, walking_functions
from .tracking import N_FORCES, TrackedWalk

HEIGHTS = ((2, 5), (8, 11))
"""Force components of the right and left foot that tell whether it stands."""

NEARBY = 12
"""Iterations granted to a start that should be close; a good prediction needs two to five."""
PATIENCE = 30
"""Iterations granted to a start that is tried once and then given up."""
ENOUGH = 60
"""Iterations granted to arcs that begin again at the tracked walk; most need ten to twenty, few of them more."""
AFAR, UNKNOWN = 1e-5, 1e-4
"""First barrier parameters from a solution for other weights, and from a walk that is no solution."""
ROUGH = 1000.0
"""How roughly problems with a larger barrier parameter are solved on the way: what costs most there is the flat bottom
of problems that will not be needed."""


@dataclass(frozen=True, kw_only=True)
class IdentificationSettings:
    """How the lower level is posed."""

    criteria: tuple[str, ...] = THESIS
    longest_arc: float = 0.12
    """Longest time [s] between given states."""
    longest_share: float = 0.125
    """The same as a share of the stride: who walks with quick steps moves more in the same time."""
    torque_floor: float = 0.01
    """Weight of the squared torques beside criteria that sum to one."""
    smoothness_floor: float = 0.05
    """Weight of the squared angular accelerations beside criteria that sum to one."""
    force_weight: float = 1e-4
    solver: InteriorPoint = field(
        default_factory=lambda: InteriorPoint(tol=1e-8, mu_initial=1e-7, mu_final=1e-7, max_iter=150)
    )


class WalkOptimum:
    """A `bilevel.problem.Response`: the optimal walk for one set of weights."""

    def __init__(self, level: "WalkLevel", problem: MechanicalProblem, solution: SparseSolution) -> None:
        self.level, self.problem, self.solution = level, problem, solution

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """Factorised optimality conditions."""
        return Sensitivity(self.problem, self.solution)

    @cached_property
    def moves(self) -> np.ndarray:
        """Derivative of (w, lam_g) in the weights, shape (n_w + n_g, n_theta)."""
        gradients = self.problem.criterion_gradients(self.solution.w)[:, self.level.indices]
        return self.sensitivity.of_objective(gradients / self.level.normalisers)

    @cached_property
    def moves_of_given(self) -> np.ndarray:
        """Derivative of (w, lam_g) in the given states, coloured (see `given_states`), shape (n_w + n_g, 4 n_q)."""
        structure = self.level.structure
        equalities = coloured_moves(structure, len(self.level.given_nodes))
        nothing = np.zeros((structure.n_w, equalities.shape[1]))
        still = np.zeros((structure.sparse.n_c, equalities.shape[1]))
        return self.sensitivity.of_conditions(nothing, equalities, still)

    def residual_by_time(self) -> np.ndarray:
        """Optimal minus measured coordinates at the nodes that are not given, shape (n_free, n_q)."""
        n_q = self.level.tracked.stride.n_q
        return (self.problem.states(self.solution.w) - self.level.tracked.stride.reference)[self.level.free, :n_q]

    @property
    def residual(self) -> np.ndarray:
        """The same, shape (n_free * n_q,)."""
        return self.residual_by_time().ravel()

    def jacobian(self) -> np.ndarray:
        """Derivative of the residual in the weights, shape (n_free * n_q, n_theta)."""
        n_q = self.level.tracked.stride.n_q
        n_x = self.level.tracked.stride.reference.size
        moves = self.moves[:n_x].reshape(-1, 2 * n_q, len(self.level.indices))
        return moves[self.level.free, :n_q].reshape(-1, len(self.level.indices))

    def predict(self, step: np.ndarray) -> SparseSolution:
        """First-order prediction after a step in the weights, shape (n_theta,)."""
        return self.sensitivity.predict(self.moves @ step)

    def cost_terms(self) -> dict[str, float]:
        """Weighted parts of the cost: each criterion, the torque floor, the smoothness floor, contact forces."""
        return self.level.cost_terms(self.problem, self.solution)


class WalkLevel:
    """A `bilevel.problem.LowerLevel` made from a tracked walk."""

    def __init__(self, tracked: TrackedWalk, settings: IdentificationSettings, workers: Workers | None = None) -> None:
        self.tracked, self.settings, self.workers = tracked, settings, workers
        self.indices = positions(settings.criteria)
        (self.torque,) = positions(["torque"])
        self.all_normalisers = tracked.problem.criteria(tracked.solution.w)
        self.normalisers = self.all_normalisers[self.indices]
        duration = float(tracked.stride.times[-1] - tracked.stride.times[0])
        self.longest_arc = min(settings.longest_arc, settings.longest_share * duration)
        self.given_nodes = arc_boundaries(tracked.stride.stages, self.longest_arc)
        self.free = np.setdiff1d(np.arange(len(tracked.stride.times)), self.given_nodes)
        functions = walking_functions(layout_of(tracked.stride.subject)).functions
        self.structure = MechanicalStructure(self._layout(), functions)
        self.arcs = Arcs(self.structure, layout_of(tracked.stride.subject))
        self.smooth = np.concatenate([np.zeros(3), np.ones(tracked.stride.n_q - 3)])
        self.acceleration_normaliser = self._acceleration_cost(tracked.problem, tracked.solution.w)
        self.given = tracked.states[self.given_nodes]

    @property
    def n_theta(self) -> int:
        """Number of weights."""
        return len(self.indices)

    def with_given(self, states: np.ndarray) -> "WalkLevel":
        """The same level with other states at the given nodes, shape (n_given, 2 n_q)."""
        level = copy(self)
        level.given = states
        return level

    def normaliser_values(self, problem: MechanicalProblem, w: np.ndarray) -> np.ndarray:
        """All criteria and the sum of squared accelerations of a walk w, shape (n_w,); shape (n_all_criteria + 1,)."""
        return np.append(problem.criteria(w), self._acceleration_cost(problem, w))

    def normalised_at(
        self, optimum: WalkOptimum, theta: np.ndarray, inflation: np.ndarray
    ) -> tuple["WalkLevel", np.ndarray]:
        """The level whose criteria and floors are divided by their values on an optimum, and theta restated for it.

        The values are lowered by what noise in the optimum adds to them, as `normaliser_values`, by half at most. See
        `restated` for the weights, shape (n_theta,).
        """
        level, values = copy(self), self.normaliser_values(optimum.problem, optimum.solution.w)
        values -= np.clip(inflation, 0.0, 0.5 * values)
        criteria = values[:-1]
        weights = np.maximum(self.restated(theta, criteria)[0], 0.0)
        level.all_normalisers, level.normalisers = criteria, criteria[self.indices]
        level.acceleration_normaliser = float(values[-1])
        return level, weights / weights.sum()

    def restated(self, theta: np.ndarray, criteria: np.ndarray) -> tuple[np.ndarray, float]:
        """Weights theta' for criteria divided by other values N'_i, shape (n_all_criteria,), that mean the same.

        With r_i = N'_i / N_i, the torque's floor f and its share r_t,

            theta'_i = k r_i theta_i  (k r_t (theta_t + f) - f for torque),  k = (1 + f) / (sum_i r_i theta_i + r_t f),

        which sum to one. Returns theta', shape (n_theta,), and k; the floor of accelerations means the same when it is
        divided by k times what divides it now. Without torque among the criteria, k = 1 / sum_i r_i theta_i, and the
        torque's floor changes a little.
        """
        ratio = criteria / self.all_normalisers
        weights, floor = ratio[self.indices] * theta, self.settings.torque_floor
        if self.torque not in self.indices:
            scale = 1.0 / float(weights.sum())
            return scale * weights, scale
        scale = (1.0 + floor) / float(weights.sum() + ratio[self.torque] * floor)
        weights = scale * weights
        weights[self.indices.index(self.torque)] += floor * (scale * ratio[self.torque] - 1.0)
        return weights, scale

    def _layout(self) -> MechanicalLayout:
        stride, tracked = self.tracked.stride, self.tracked
        everything = tuple(range(2 * stride.n_q))
        boundary = Boundary(tuple((int(node), everything) for node in self.given_nodes))
        layout = MechanicalLayout(stride.stages, stride.n_q, N_FORCES, ROOT, boundary)
        functions = walking_functions(layout_of(stride.subject)).functions
        return without_redundant_contacts(layout, functions, tracked.problem.data.p, tracked.states)

    def _acceleration_cost(self, problem: MechanicalProblem, w: np.ndarray) -> float:
        n_q = self.tracked.stride.n_q
        a = problem.points(w)[:, 2 * n_q : 3 * n_q]
        return float(problem.shared.weights @ (a**2 @ self.smooth))

    def problem(self, theta: np.ndarray) -> MechanicalProblem:
        """Lower level for weights theta, shape (n_theta,)."""
        settings = self.settings
        weights = np.zeros(len(ALL))
        weights[self.indices] = theta / self.normalisers
        weights[self.torque] += settings.torque_floor / self.all_normalisers[self.torque]
        given = self.tracked.states.copy()
        given[self.given_nodes] = self.given
        data = replace(
            self.tracked.problem.data,
            theta=weights,
            given=given,
            tracking=np.zeros_like(self.tracked.problem.data.tracking),
            acceleration_weights=2.0 * settings.smoothness_floor / self.acceleration_normaliser * self.smooth,
            force_weight=settings.force_weight,
        )
        return MechanicalProblem(self.structure, data)

    def respond(self, theta: np.ndarray, start: SparseSolution) -> WalkOptimum:
        """Solve for theta, shape (n_theta,), from a nearby solution; arcs that are lost from the tracked walk again."""
        near = Attempt(replace(self.settings.solver, max_iter=NEARBY), start)
        return self._solve(self.problem(theta), (near, self._afresh))

    def respond_nearby(self, theta: np.ndarray, start: SparseSolution) -> WalkOptimum:
        """Solve for theta, shape (n_theta,), from a prediction that is good or not worth pursuing."""
        return self._solve(self.problem(theta), (Attempt(replace(self.settings.solver, max_iter=PATIENCE), start),))

    def respond_from_afar(
        self, theta: np.ndarray, start: SparseSolution, done: Callable[[int], None] | None = None
    ) -> WalkOptimum:
        """Solve for theta, shape (n_theta,), from a solution for quite other weights."""
        attempts = [Attempt(self._from(barrier), start) for barrier in (AFAR, UNKNOWN)]
        return self._solve(self.problem(theta), attempts, done)

    def from_tracking(self, theta: np.ndarray, done: Callable[[int], None] | None = None) -> WalkOptimum:
        """Solve for theta, shape (n_theta,), from the tracked walk; `done(n_arcs_solved)` may raise to cancel."""
        attempts = [Attempt(self._from(barrier), self.tracked.solution.w) for barrier in (UNKNOWN, AFAR)]
        return self._solve(self.problem(theta), attempts, done)

    def second_look(self, optimum: WalkOptimum, done: Callable[[int], None] | None = None) -> WalkOptimum:
        """In each arc the better one of an optimum and what the tracked walk leads to for the same weights.

        What is not found with some patience is not better: the optimum is known already.
        """
        problem = optimum.problem
        fresh = self.arcs.solve_each(problem, (self._afresh,), self.workers, done)
        return WalkOptimum(self, problem, self.arcs.improved(problem, optimum.solution, fresh))

    @property
    def _afresh(self) -> Attempt:
        return Attempt(replace(self._from(UNKNOWN), max_iter=ENOUGH), self.tracked.solution.w)

    def _from(self, barrier: float) -> InteriorPoint:
        # Far from the solution a small barrier parameter would press the iterates against the inequalities, and the
        # exact Hessian is not convex; where it is not, a multiple of the identity makes for small steps.
        return replace(self.settings.solver, mu_initial=barrier, gauss_newton=True, kappa_error=ROUGH)

    def _solve(
        self, problem: MechanicalProblem, attempts: Sequence[Attempt], done: Callable[[int], None] | None = None
    ) -> WalkOptimum:
        return WalkOptimum(self, problem, self.arcs.solve(problem, attempts, self.workers, done))

    def cost_terms(self, problem: MechanicalProblem, solution: SparseSolution) -> dict[str, float]:
        """Weighted parts of the cost at a solution."""
        w, d = solution.w, problem.data
        criteria = problem.criteria(w)
        names = list(ALL)
        floor = self.settings.torque_floor * criteria[self.torque] / self.all_normalisers[self.torque]
        terms = {names[i]: float(d.theta[i] * criteria[i]) for i in self.indices}
        if self.torque in self.indices:
            terms["torque"] -= float(floor)
        smooth = self.settings.smoothness_floor * self._acceleration_cost(problem, w) / self.acceleration_normaliser
        forces = problem.points(w)[:, 3 * self.tracked.stride.n_q :]
        contact = 0.5 * d.force_weight * float(problem.shared.weights @ np.sum(forces**2, axis=1))
        return terms | {"torque_floor": float(floor), "smoothness_floor": smooth, "contact_force_floor": contact}


def arc_boundaries(stages: tuple[ContactStage, ...], longest: float) -> np.ndarray:
    """Nodes with given states: ends, changes between stance and swing, and between them at most `longest` [s] apart."""
    ends = np.concatenate([[0], np.cumsum([s.n_intervals for s in stages])])
    stands = [tuple(any(i in s.active for i in foot) for foot in HEIGHTS) for s in stages]
    changes = [int(ends[i]) for i in range(1, len(stages)) if stands[i] != stands[i - 1]]
    cuts = [0, *changes, int(ends[-1])]
    lengths = np.concatenate([np.full(s.n_intervals, s.duration / s.n_intervals) for s in stages])
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    nodes: set[int] = set(cuts)
    for first, last in zip(cuts[:-1], cuts[1:], strict=True):
        pieces = max(1, int(np.ceil((times[last] - times[first]) / longest - 1e-9)))
        nodes |= {first + round((last - first) * i / pieces) for i in range(1, pieces)}
    return np.array(sorted(nodes))
