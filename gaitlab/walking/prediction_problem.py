r"""The walk that is to be predicted: no state is given any more, only periodicity, the task and a weak habit.

The identified gait was optimal between given states of the body. Giving them had a price: the multipliers p_k of these
conditions, the pull of everything that the criteria leave out. For a prediction the states are free, the prices are
kept, and springs hold the posture softly:

.. math::

    \min_{x, f, T} \; \frac{L_0}{L} J_\theta(x, f, T)
        + \sum_k \Big( p_k' e_k + \tfrac12 e_k' W e_k \Big) + p_T \log \frac{T}{T_0},
    \qquad e_k = \Big(q_k - \hat q_k, \; \tfrac{T}{T_0} v_k - \hat v_k\Big)

with the cost J_theta per distance, instants k at the same share of the stride, equations of motion and contacts as
before, and a stride that ends as it began, shifted by its length: x_N - x_0 = d(L). With an unchanged body and task
the identified gait satisfies the optimality conditions of this problem exactly, as the prices come from there.

The reference follows what was asked for: the pelvis travels L instead of L_0, and stands as high as the changed legs
carry it at the old joint angles.
"""

from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space

from ..errors import ProblemError
from ..multibody.dynamics import layout_of
from ..nlp.sparse_problem import SparseProblem, multiply_transposed
from ..nlp.sparse_solution import SparseSolution, certify
from ..transcription.contact_rank import without_redundant_contacts
from ..transcription.hermite import GAUSS_POINTS, hermite_coefficients
from ..transcription.mechanical_layout import Boundary, ContactRow, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalProblem, MechanicalStructure
from ..transcription.output_limits import LimitedProblem, LimitedStructure
from .identified_gait import IdentifiedGait
from .model import ROOT, walking_functions
from .situation import Situation
from .tracking import N_FORCES, planted_heights

PLACE = (0, 1)
"""Where on the floor the stride begins is given."""

SWINGING = (5, 6, 9, 12, 15, 18, 21)
"""Coordinates whose excursions make the length of a stride: rotation of the pelvis about the vertical, flexion of hips,
knees and ankles."""


@dataclass(frozen=True, kw_only=True)
class HabitSettings:
    """How firmly the identified posture is held where states were given."""

    angle: float = 5.0
    """Weight of an angle's deviation of 1 rad at one instant, beside criteria whose weights sum to one."""
    translation: float = 4.0
    """Weight of a deviation of the pelvis of 1 m, relative to that of an angle."""
    velocity: float = 0.01
    """Weight of a deviation of 1 rad/s, relative to that of an angle."""

    def firmer(self, factor: float) -> "HabitSettings":
        """The same with all weights multiplied by a factor."""
        return replace(self, angle=factor * self.angle)


class PredictionProblem:
    """The family of problems around one identified gait; `at` gives its members."""

    def __init__(self, gait: IdentifiedGait, situation: Situation, habit: HabitSettings) -> None:
        self.gait, self.stride, self.first_situation = gait, gait.stride, situation
        self.n_q = self.stride.n_q
        self.states = gait.states  # (N + 1, 2 n_q)
        self.duration = gait.duration
        self.shift = self.states[-1] - self.states[0]  # (2 n_q,)
        self.structure = self._structure(situation)
        self.limited = LimitedStructure(self.structure, tuple(situation.torques))
        self.W = self._springs(habit)
        self.prices = np.zeros_like(self.states)
        self.rows = self._periodic_rows()
        self.start = self._first_solution(situation)

    @property
    def length(self) -> float:
        """Stride length of the identified gait [m]."""
        return float(self.shift[0])

    def at(self, situation: Situation, log_time: float, pull: np.ndarray | None = None) -> SparseProblem:
        """The problem for a body and a task, T = T_0 exp(log_time), and a pull on the ends.

        `pull` holds the multipliers of the periodicity, shape (n_periodic,); they count as a linear cost.
        """
        inner = self.mechanical(situation, log_time, pull)
        if not self.limited.limits:
            return inner
        bounds = np.array([situation.torques[limit] for limit in self.limited.limits])
        return LimitedProblem(inner, self.limited, bounds)

    def mechanical(self, situation: Situation, log_time: float, pull: np.ndarray | None = None) -> MechanicalProblem:
        """The same without limits of torques; `pull` of shape (n_periodic,)."""
        stretch = float(np.exp(log_time))
        length = situation.task.length(self.duration * stretch)
        scale = self.length / length
        low, high = situation.ranges()
        linear = self.prices.copy()
        linear[:, self.n_q :] *= stretch
        if pull is not None:
            linear[-1] += self.rows.T @ pull
            linear[0] -= self.rows.T @ pull
        tracking = self.W.copy()
        tracking[:, self.n_q :] *= stretch**2
        reference = self.reference(situation, stretch, length)
        held = tracking > 0.0
        reference[held] -= linear[held] / tracking[held]
        base = self.gait.problem.data
        data = replace(
            base,
            p=situation.parameters(),
            theta=scale * self.gait.raw_weights(situation.weights),
            acceleration_weights=scale * base.acceleration_weights,
            force_weight=scale * base.force_weight,
            reference=reference,
            tracking=tracking,
            given=self.states,
            lower=low,
            upper=high,
        )
        return MechanicalProblem(self._stretched(stretch), data)

    def reference(self, situation: Situation, stretch: float, length: float) -> np.ndarray:
        """Posture that the habit holds, for a stretched time and a stride length [m], shape (N + 1, 2 n_q)."""
        reference, n_q, longer = self.states.copy(), self.n_q, length / self.length
        middle = np.zeros(2 * n_q)
        middle[list(SWINGING)] = self.states[:-1, SWINGING].mean(axis=0)
        middle[0] = self.states[0, 0]
        for k in (0, *SWINGING):
            reference[:, [k, n_q + k]] = middle[[k, n_q + k]] + longer * (self.states - middle)[:, [k, n_q + k]]
        stages = self.stride.stages
        reference[:, 2] += planted_heights(self.stride.subject, stages, self.states[:, :n_q])
        reference[:, 2] -= planted_heights(situation.subject, stages, reference[:, :n_q])
        reference[:, n_q:] /= stretch
        return reference

    def gap(self, situation: Situation, log_time: float) -> np.ndarray:
        """Wanted differences between end and start in the periodic directions, shape (n_periodic,)."""
        stretch = float(np.exp(log_time))
        wanted = self.shift.copy()
        wanted[0] = situation.task.length(self.duration * stretch)
        wanted[self.n_q :] /= stretch
        return self.rows @ wanted

    def ends_apart(self, w: np.ndarray) -> np.ndarray:
        """Differences between end and start of w, shape (n_w,), in the periodic directions, shape (n_periodic,)."""
        width = 2 * self.n_q
        last = width * self.structure.layout.n_intervals
        return self.rows @ (w[last : last + width] - w[:width])

    def pull_columns(self) -> np.ndarray:
        """Derivative of the cost's gradient in the pull, shape (n_w, n_periodic)."""
        width = 2 * self.n_q
        last = width * self.structure.layout.n_intervals
        columns = np.zeros((self.structure.n_w, len(self.rows)))
        columns[last : last + width] = self.rows.T
        columns[:width] -= self.rows.T
        return columns

    def _structure(self, situation: Situation) -> MechanicalStructure:
        stride, functions = self.stride, walking_functions(layout_of(self.stride.subject)).functions
        limited = tuple(sorted({*situation.lower, *situation.upper}))
        place = Boundary(((0, PLACE),))
        layout = MechanicalLayout(stride.stages, self.n_q, N_FORCES, ROOT, place, limited)
        layout = without_redundant_contacts(layout, functions, self.gait.problem.data.p, self.states)
        return MechanicalStructure(layout, functions)

    def _stretched(self, stretch: float) -> MechanicalStructure:
        """The structure with all durations stretched; patterns and compiled functions stay the same objects."""
        _ = self.structure.sparse
        stretched = copy(self.structure)
        lengths = stretch * self.structure.layout.interval_lengths()
        stretched.coefficients = hermite_coefficients(GAUSS_POINTS, lengths).reshape(2 * len(lengths), 3, 4)
        stretched.weights = np.repeat(lengths / 2.0, 2)
        return stretched

    def _springs(self, habit: HabitSettings) -> np.ndarray:
        """Weights W at the instants whose states were given, shape (N + 1, 2 n_q)."""
        one = np.concatenate([np.ones(self.n_q), np.full(self.n_q, habit.velocity)])
        one[[0, 1, 2, self.n_q, self.n_q + 1, self.n_q + 2]] *= habit.translation
        W = np.zeros_like(self.states)
        W[self.gait.given_nodes] = habit.angle * one
        return W

    def _periodic_rows(self) -> np.ndarray:
        """Directions of the state in which the end must repeat the start, orthonormal, shape (n_periodic, 2 n_q).

        Contacts hold at both ends already: what follows from them is left out.
        """
        layout, n_f = self.structure.layout, N_FORCES
        first = {row.component for row in layout.contact_equalities() if row.node == 0}
        stands = set(self.stride.stages[-1].active)
        last = {i for i in stands if i % 3 == 2} | {n_f + i for i in stands}
        common = sorted(first & last)
        width = 2 * self.n_q
        if not common:
            return np.eye(width)
        derivatives = self.structure.evaluate["node_derivatives"]
        p = self.gait.problem.data.p
        jacobian = derivatives(self.states, p, np.zeros((len(self.states), 2 * n_f)))[0][-1]  # (2 n_q, 2 n_f)
        return null_space(jacobian[:, common].T).T

    def _first_solution(self, situation: Situation) -> SparseSolution:
        """The identified gait as a solution of this problem; sets the prices that make it one."""
        x, problem = self.gait.solution, self.at(situation, 0.0)
        values = problem.values(x.w)
        if np.any(values.c <= 0.0):
            raise ProblemError("the identified gait lies outside the limits of the first problem of the continuation")
        s, lam_c = values.c.copy(), x.mu / values.c
        old, new = self.gait.problem.shared, self.structure
        before = [*range(new.n_cone), *(old.n_cone + old.clear.index(row) for row in new.clear if row in old.clear)]
        after = [*range(new.n_cone), *(new.n_cone + i for i, row in enumerate(new.clear) if row in old.clear)]
        s[after], lam_c[after] = x.s[before], x.lam_c[before]
        lam_g = np.zeros(problem.structure.n_g)
        n_residual = 2 * new.layout.n_intervals * ROOT
        lam_g[:n_residual] = x.lam_g[:n_residual]
        contact: dict[ContactRow, float] = dict(zip(old.contact, x.lam_g[n_residual:], strict=False))
        lam_g[n_residual : n_residual + len(new.contact)] = [contact.get(row, 0.0) for row in new.contact]
        start = replace(x, s=s, lam_g=lam_g, lam_c=lam_c)
        slope = lagrangian_gradient(problem, start)[: self.states.size].reshape(self.states.shape)
        given = self.gait.given_nodes
        self.prices[given] = -slope[given]
        return certify(self.at(situation, 0.0), start, mu=x.mu, iterations=0, status=x.status)


def lagrangian_gradient(problem: SparseProblem, x: SparseSolution) -> np.ndarray:
    """Gradient of f + lam_g' g - lam_c' c at a point, shape (n_w,)."""
    d, s = problem.derivatives(x.w, x.lam_g, x.lam_c), problem.structure
    equalities = multiply_transposed(s.jac_g, d.jac_g, x.lam_g, s.n_w)
    return d.grad + equalities - multiply_transposed(s.jac_c, d.jac_c, x.lam_c, s.n_w)
