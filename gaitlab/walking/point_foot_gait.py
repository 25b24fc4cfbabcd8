r"""The thesis's gait as a lower level: three single supports on point feet with rigid impacts between them.

Hatz (2014), problem (15.2)-(15.6): stages right, impact, left, impact, right; the impacts have no duration. Each
criterion counts as its mean over a stage, the integral over normalised time,

.. math:: \sum_{k} \frac{1}{T_k} \int_0^{T_k} \sum_i \frac{\theta_i}{N_i} \phi_i \, dt, \qquad
    \theta \ge 0, \; \sum_i \theta_i = 1.

The durations T_k are those that the thesis found. The state is given at both ends of every stage, and across an impact
the given velocities jump by the law of a rigid inelastic impact, M (v+ - v-) = J' Lambda, J v+ = 0. With the thesis's
own conditions, posture at the start and place of the pelvis at the end, the optimum falls ballistically and turns
its feet by several radians. As states are given, the stages share only the weights and are solved one by one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from uuid import uuid4

import numpy as np

from ..multibody.dynamics import layout_of, parameter_vector
from ..nlp.interior_point import InteriorPoint, Iterate
from ..nlp.sensitivity import Sensitivity
from ..nlp.solution import KKTResiduals
from ..nlp.sparse_solution import SparseSolution, Status, certify
from ..nlp.workers import Workers
from ..transcription.contact_rank import without_redundant_contacts
from ..transcription.mechanical_layout import Boundary, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure
from .arcs import ArcTask, Attempt, solve_in_turn
from .criteria import ALL, THESIS, positions
from .gait_data import MeasuredGait, PointFootGait
from .gait_guess import Curves, StandingPoints, smooth_states
from .model import POINTS, ROOT, walking_functions
from .tracking import N_FORCES

ANGLE_LIMIT = 1.5
"""Bound of all joint angles and of the pelvis's [rad], block C3 of (15.5)."""

TORQUE_LIMIT = 500.0
"""Bound of the joint torques [N*m], block C3 of (15.5): so loose that it is only checked at the solution."""

ANGLES = tuple(range(3, 24))
"""Coordinates that are angles."""

CALM = 0.01
"""Weight [s^2] of errors of the velocities of the first guess beside those of the coordinates, while tracking: it keeps
the nodes from ringing."""

PATH = (10.0, 1.0, 0.1)
"""Weights of half the mean squared residual on the way from the measurements to the optimal gait. At the last one the
motion is still near the measurements for any weights, and already tells what they must be."""
PATIENCE = 40
"""Iterations granted on such a way."""

NEAR_BARRIER = 1e-5
"""First barrier parameter where motion and forces are known nearly, but no multipliers."""

NEARBY = 10
"""Iterations granted to a start that should be close."""


@dataclass(frozen=True, kw_only=True)
class GaitLevelSettings:
    """How the lower level is solved."""

    solver: InteriorPoint = field(
        default_factory=lambda: InteriorPoint(tol=1e-8, mu_initial=1e-7, mu_final=1e-7, max_iter=150)
    )
    barriers: tuple[float, ...] = (1e-4, 1e-3, 1e-2)
    """First barrier parameters that are tried in turn from far starts."""


class GaitOptimum:
    """A `bilevel.problem.Response`: the optimal gait for one set of weights."""

    def __init__(
        self, level: "GaitLevel", problems: tuple[MechanicalProblem, ...], solutions: Sequence[SparseSolution]
    ) -> None:
        self.level, self.problems, self.solutions = level, problems, tuple(solutions)
        self.solution = _joined(self.solutions)

    @cached_property
    def sensitivities(self) -> tuple[Sensitivity, ...]:
        """Factorised optimality conditions of each stage."""
        return tuple(Sensitivity(p, x) for p, x in zip(self.problems, self.solutions, strict=True))

    @cached_property
    def _moves(self) -> list[np.ndarray]:
        """Derivative of (w, lam_g) of each stage in the weights, shapes (n_w + n_g, n_theta)."""
        scale = self.level.running_scale
        return [
            sensitivity.of_objective(problem.criterion_gradients(x.w)[:, self.level.indices] * scale[k])
            for k, (problem, x, sensitivity) in enumerate(
                zip(self.problems, self.solutions, self.sensitivities, strict=True)
            )
        ]

    @property
    def states(self) -> tuple[np.ndarray, ...]:
        """States at the nodes of each stage, shapes (N_k + 1, 2 n_q)."""
        return tuple(p.states(x.w) for p, x in zip(self.problems, self.solutions, strict=True))

    def residual_by_time(self) -> np.ndarray:
        """Optimal minus measured coordinates in standard deviations, inside the stages, shape (n_free, n_q)."""
        measured, n_q = self.level.measured, self.level.n_q
        gaps = [x[1:-1, :n_q] - q[1:-1] for x, q in zip(self.states, measured.q, strict=True)]
        return np.concatenate(gaps) / measured.deviation

    @property
    def residual(self) -> np.ndarray:
        """The same, shape (n_free * n_q,)."""
        return self.residual_by_time().ravel()

    def jacobian(self) -> np.ndarray:
        """Derivative of the residual in the weights, shape (n_free * n_q, n_theta)."""
        n_q, rows = self.level.n_q, list[np.ndarray]()
        for moves, states in zip(self._moves, self.states, strict=True):
            inside = moves[: states.size].reshape(len(states), 2 * n_q, -1)[1:-1, :n_q]
            rows.append(inside / self.level.measured.deviation[:, None])
        return np.concatenate(rows).reshape(-1, self.level.n_theta)

    def predict(self, step: np.ndarray) -> SparseSolution:
        """First-order prediction after a step in the weights, shape (n_theta,)."""
        parts = zip(self.sensitivities, self._moves, strict=True)
        return _joined([sensitivity.predict(moves @ step) for sensitivity, moves in parts])

    def is_minimum(self) -> bool:
        """Second-order sufficiency in every stage."""
        return all(sensitivity.is_minimum() for sensitivity in self.sensitivities)

    def criteria(self) -> np.ndarray:
        """Means of the criteria, summed over the stages, shape (n_theta,)."""
        means = [
            problem.criteria(x.w)[self.level.indices] / duration
            for problem, x, duration in zip(self.problems, self.solutions, self.level.gait.durations, strict=True)
        ]
        return np.sum(means, axis=0)

    def squares(self, first: int, last: int) -> float:
        """Mean over each stage of the squares of entries first to last of (q, v, a, f), summed."""
        total = 0.0
        for problem, x, duration in zip(self.problems, self.solutions, self.level.gait.durations, strict=True):
            points = problem.points(x.w)[:, first:last]
            total += float(problem.shared.weights @ np.sum(points**2, axis=1)) / duration
        return total

    def largest_torque(self) -> float:
        """Largest joint torque at the Gauss points [N*m]."""
        n_q = self.level.n_q
        outputs = [p.outputs(x.w)[:, ROOT:n_q] for p, x in zip(self.problems, self.solutions, strict=True)]
        return max(float(np.abs(torques).max()) for torques in outputs)


class GaitLevel:
    """A `bilevel.problem.LowerLevel` of a gait and its measurements."""

    def __init__(
        self,
        gait: PointFootGait,
        measured: MeasuredGait,
        settings: GaitLevelSettings | None = None,
        first: tuple[np.ndarray, ...] | None = None,
        workers: Workers | None = None,
    ) -> None:
        """`first` are states to start from, per stage (N_k + 1, 2 n_q); smoothed measurements by default.

        Workers solve the stages side by side.
        """
        self.workers, self._key = workers, uuid4().hex
        self._tracked: dict[int, SparseSolution] = {}
        self.gait, self.measured, self.settings = gait, measured, settings or GaitLevelSettings()
        self.indices = positions(THESIS)
        self.n_q = gait.subject.n_q
        subject = replace(gait.subject, contacts={name: gait.subject.contacts[name] for name in POINTS})
        self.layout = layout_of(subject)
        self.p = np.concatenate([parameter_vector(subject), np.zeros(3 * (self.n_q - ROOT))])
        self.running_scale = [1.0 / (gait.normalisers * duration) for duration in gait.durations]
        self.first = first if first is not None else tuple(self._smoothed(k) for k in range(len(gait.durations)))
        self.structures = tuple(self._structure(k) for k in range(len(gait.durations)))

    @property
    def n_theta(self) -> int:
        """Number of weights."""
        return len(self.indices)

    def _structure(self, k: int) -> MechanicalStructure:
        functions = walking_functions(self.layout).functions
        n, every = self.gait.n_intervals[k], tuple(range(2 * self.n_q))
        boundary = Boundary(((0, every), (n, every)))
        layout = MechanicalLayout((self.gait.stages[k],), self.n_q, N_FORCES, ROOT, boundary, ANGLES)
        return MechanicalStructure(without_redundant_contacts(layout, functions, self.p, self.first[k]), functions)

    def problems(self, theta: np.ndarray, tracking: float = 0.0) -> tuple[MechanicalProblem, ...]:
        """The stages for weights theta, shape (n_theta,), and a weight of half the mean squared residual."""
        return tuple(
            MechanicalProblem(structure, self._data(k, theta, tracking)) for k, structure in enumerate(self.structures)
        )

    def _data(self, k: int, theta: np.ndarray, tracking: float) -> MechanicalData:
        gait, n_q = self.gait, self.n_q
        weights = np.zeros(len(ALL))
        floor = gait.torque_floor * np.array([name == "torque" for name in THESIS])
        weights[self.indices] = (theta + floor) * self.running_scale[k]
        reference = np.hstack([self.measured.q[k], self.first[k][:, n_q:]])
        n_measured = n_q * sum(len(q) - 2 for q in self.measured.q)
        errors = np.zeros_like(reference)
        errors[1:-1, :n_q] = tracking / n_measured / self.measured.deviation**2
        errors[1:-1, n_q:] = CALM * errors[1:-1, :n_q]
        smooth = np.zeros(n_q)
        smooth[list(ANGLES)] = gait.acceleration_weight / gait.durations[k]
        return MechanicalData(
            p=self.p,
            theta=weights,
            reference=reference,
            tracking=errors,
            given=self.first[k],
            lower=np.full(n_q, -ANGLE_LIMIT),
            upper=np.full(n_q, ANGLE_LIMIT),
            acceleration_weights=smooth,
            force_weight=gait.force_weight / gait.durations[k],
        )

    def respond(self, theta: np.ndarray, start: SparseSolution) -> GaitOptimum:
        """Solve for theta, shape (n_theta,), from a nearby solution.

        Stages for which it is not near go the way from the tracked motion, if `track` has found one.
        """
        problems, near = self.problems(theta), replace(self.settings.solver, max_iter=NEARBY)
        found = self._solve(problems, dict(enumerate(self.split(start))), (near,))
        lost = [k for k, x in found.items() if x.status is not Status.SOLVED]
        if lost and self._tracked:
            found |= self._along(theta, (*PATH[1:], 0.0), {k: self._tracked[k] for k in lost})
        elif lost:
            found |= self._solve(problems, {k: found[k] for k in lost}, self._far)
        return GaitOptimum(self, problems, [found[k] for k in range(len(problems))])

    def from_measurements(self, theta: np.ndarray) -> GaitOptimum:
        """Solve for theta, shape (n_theta,), from the measurements: tracking first, then less, at last none."""
        return self.follow(theta, 0.0, self.track(theta))

    def track(self, theta: np.ndarray) -> GaitOptimum:
        """The motion near the measurements for theta, shape (n_theta,), with the last weight of tracking of `PATH`."""
        problems = self.problems(theta, PATH[0])
        convex = replace(self._far[0], gauss_newton=True, max_iter=PATIENCE)
        guesses = {k: self._guess(problem, k) for k, problem in enumerate(problems)}
        self._tracked = self._solve(problems, guesses, (convex, *self._far))
        found = self._along(theta, PATH[1:], self._tracked)
        return GaitOptimum(self, self.problems(theta, PATH[-1]), [found[k] for k in range(len(problems))])

    def follow(self, theta: np.ndarray, tracking: float, start: GaitOptimum) -> GaitOptimum:
        """Solve for theta, shape (n_theta,), and a weight of tracking from an optimum for others."""
        found = self._along(theta, (tracking,), dict(enumerate(start.solutions)))
        problems = self.problems(theta, tracking)
        return GaitOptimum(self, problems, [found[k] for k in range(len(problems))])

    def _along(
        self, theta: np.ndarray, path: Sequence[float], starts: dict[int, SparseSolution]
    ) -> dict[int, SparseSolution]:
        """Follow the optima of some stages along weights of tracking."""
        methods = (replace(self.settings.solver, max_iter=PATIENCE), *self._far)
        for tracking in path:
            starts = self._solve(self.problems(theta, tracking), starts, methods)
        return starts

    def from_forces(self, theta: np.ndarray, forces: Sequence[np.ndarray]) -> GaitOptimum:
        """Solve for theta, shape (n_theta,), from the first states and forces of the floor at the Gauss points.

        The forces [body weights] of each stage have shape (2 N_k, n_f), those of points in the air are not read.
        """
        problems, starts = self.problems(theta), dict[int, np.ndarray]()
        for k, problem in enumerate(problems):
            starts[k], index = self._guess(problem, k), problem.shared.force_index
            starts[k][index[index >= 0]] = forces[k][index >= 0]
        near = replace(self.settings.solver, mu_initial=NEAR_BARRIER)
        found = self._solve(problems, starts, (near, *self._far))
        return GaitOptimum(self, problems, [found[k] for k in range(len(problems))])

    def at_start(self, theta: np.ndarray) -> GaitOptimum:
        """The first guess for theta, shape (n_theta,), in the form of an optimum, with its residuals."""
        problems, found = self.problems(theta), list[SparseSolution]()
        for k, problem in enumerate(problems):
            w, s = self._guess(problem, k), problem.structure
            x = Iterate(w, np.ones(s.n_c), np.zeros(s.n_g), np.zeros(s.n_c))
            found.append(certify(problem, x, mu=1.0, iterations=0, status=Status.ITERATION_LIMIT))
        return GaitOptimum(self, problems, found)

    @property
    def _far(self) -> tuple[InteriorPoint, ...]:
        return tuple(replace(self.settings.solver, mu_initial=barrier) for barrier in self.settings.barriers)

    def _solve(
        self,
        problems: tuple[MechanicalProblem, ...],
        starts: Mapping[int, SparseSolution | np.ndarray],
        methods: Sequence[InteriorPoint],
    ) -> dict[int, SparseSolution]:
        """Solve the stages that have a start."""
        attempts = {k: tuple(Attempt(method, start) for method in methods) for k, start in starts.items()}
        if self.workers is None:
            return {k: solve_in_turn(problems[k], own) for k, own in attempts.items()}
        tasks = [
            ArcTask(
                key=f"{self._key}-{k}",
                model=self.layout,
                layout=problems[k].shared.layout,
                data=problems[k].data,
                attempts=own,
            )
            for k, own in attempts.items()
        ]
        return dict(zip(attempts, self.workers.map(tasks), strict=True))

    def split(self, x: SparseSolution) -> list[SparseSolution]:
        """The stages of a joint solution."""
        sizes = [structure.sparse for structure in self.structures]
        w = np.split(x.w, np.cumsum([s.n_w for s in sizes])[:-1])
        lam_g = np.split(x.lam_g, np.cumsum([s.n_g for s in sizes])[:-1])
        cuts = np.cumsum([s.n_c for s in sizes])[:-1]
        s, lam_c = np.split(x.s, cuts), np.split(x.lam_c, cuts)
        return [replace(x, w=a, s=b, lam_g=c, lam_c=d) for a, b, c, d in zip(w, s, lam_g, lam_c, strict=True)]

    def _smoothed(self, k: int) -> np.ndarray:
        """Smoothed measurements of a stage, its standing point in place, shape (N_k + 1, 2 n_q)."""
        gait, q = self.gait, self.measured.q[k]
        curves = Curves(ends=gait.states[k], duration=gait.durations[k], n=gait.n_intervals[k])
        functions = walking_functions(self.layout).functions
        standing = StandingPoints(functions=functions, p=self.p, active=gait.stages[k].active)
        return smooth_states(curves, q, self.measured.deviation, standing)

    def _guess(self, problem: MechanicalProblem, k: int) -> np.ndarray:
        """First guess of a stage: smoothed measurements, and the forces of the floor that balance them best."""
        shared, n_q = problem.shared, self.n_q
        w = np.zeros(shared.n_w)
        w[: self.first[k].size] = self.first[k].ravel()
        z = problem.points(w)
        missing = problem.outputs(w)[:, :ROOT]
        by_force = shared.evaluate["output_jacobian"](z, self.p)[0][:, 3 * n_q :, :ROOT]  # (2 N, n_f, 6)
        for point, index in enumerate(shared.force_index):
            used = index >= 0
            w[index[used]] = -np.linalg.lstsq(by_force[point, used].T, missing[point], rcond=None)[0]
        return w


def _joined(parts: Sequence[SparseSolution]) -> SparseSolution:
    """All stages as one solution of the problem that they form together."""
    residuals = KKTResiduals(
        stationarity=max(x.residuals.stationarity for x in parts),
        primal=max(x.residuals.primal for x in parts),
        complementarity=max(x.residuals.complementarity for x in parts),
    )
    return SparseSolution(
        w=np.concatenate([x.w for x in parts]),
        s=np.concatenate([x.s for x in parts]),
        lam_g=np.concatenate([x.lam_g for x in parts]),
        lam_c=np.concatenate([x.lam_c for x in parts]),
        f=float(sum(x.f for x in parts)),
        mu=max(x.mu for x in parts),
        iterations=max(x.iterations for x in parts),
        residuals=residuals,
        status=next((x.status for x in parts if x.status is not Status.SOLVED), Status.SOLVED),
    )
