r"""The weights together with the states between the arcs, from every measured frame.

`identification` gives the states between arcs as tracked. Where the model explains a walk to within the noise of its
measurement, errors of these states are what spoils the weights: tracking smooths them, and at changes of contact
velocities bend within a few milliseconds. Then they are unknowns like the weights:

.. math:: \min_{\theta, X} \; \tfrac1{2 \sigma^2} \sum_t (q^*_t - \hat q_t)' G_t (q^*_t - \hat q_t)
          + \tfrac12 |c(X)|^2, \qquad \theta \ge 0, \; \sum \theta = 1,

with all given states X, the optimal arcs q*(theta, X) between them, coordinates of single frames and what their markers
tell of them, G = J'J (to first order these are the markers' own distances), and the conditions c of planted feet.
Gauss-Newton with Marquardt's damping; X is eliminated from each step, and the covariance of the weights is the marginal
one. The criteria are divided by their values on the estimated optimum itself, and sigma is the markers' own misfit:
both are renewed until they stay.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import cho_factor, cho_solve, qr

from ..bilevel.result import WeightEstimate
from ..bilevel.simplex_step import simplex_minimiser
from ..bilevel.uncertainty import weight_uncertainty
from ..nlp.sparse_solution import SparseSolution, Status
from .given_states import StateConditions, sampling_table, spread_moves
from .identification import WalkLevel, WalkOptimum
from .tracking import MeasuredStride

Progress = Callable[[int, float], None]


@dataclass(frozen=True, kw_only=True)
class MeasuredFrames:
    """Coordinates as the markers of single frames say."""

    times: np.ndarray
    """From the first stored frame [s], shape (n_frames,)."""
    q: np.ndarray
    """Unsmoothed coordinates, gait frame [m, rad], shape (n_frames, n_q); NaN where markers are missing."""
    little_smoothed: np.ndarray
    """Coordinates smoothed as little as their noise allows [m, rad], shape (n_frames, n_q)."""
    information: np.ndarray
    """What the markers tell of `q`, J'J [m^2 per unit of the coordinates], shape (n_frames, n_q, n_q)."""

    noise: float
    """Standard deviation of a marker's coordinate [m]."""

    def of_stride(self, stride: MeasuredStride) -> "MeasuredFrames":
        """The known frames within a stride, its floor at zero."""
        inside = (self.times >= stride.times[0] - 1e-9) & (self.times <= stride.times[-1] + 1e-9)
        inside &= np.isfinite(self.q).all(axis=1)
        floor = np.zeros(self.q.shape[1])
        floor[2] = stride.floor
        return MeasuredFrames(
            times=self.times[inside],
            q=self.q[inside] - floor,
            little_smoothed=self.little_smoothed[inside] - floor,
            information=self.information[inside],
            noise=self.noise,
        )

    @cached_property
    def roots(self) -> np.ndarray:
        """R with R'R = information, shape (n_frames, n_q, n_q)."""
        values, vectors = np.linalg.eigh(self.information)
        return np.sqrt(np.maximum(values, 0.0))[:, :, None] * np.swapaxes(vectors, 1, 2)


def closer_stride(stride: MeasuredStride, frames: MeasuredFrames) -> MeasuredStride:
    """The stride with the little smoothed motion as its reference: where the search starts from."""
    spline = CubicSpline(frames.times, frames.little_smoothed)
    return replace(stride, reference=np.hstack([spline(stride.times), spline(stride.times, 1)]))


@dataclass(frozen=True, kw_only=True)
class JointSearch:
    """Settings of the method."""

    place: float = 2e-4
    """Error of a planted point's place that weighs as much as a standard deviation of a coordinate [m]."""
    speed: float = 2e-3
    """The same of its speed [m/s]."""
    least_sigma: float = 5e-5
    """Markers do not count as measured or computed better than this [m]: the grid's own error."""
    rounds: int = 6
    """How often normalisers and standard deviations are renewed at most."""
    tol_round: float = 1e-3
    """Ended when no weight moves by more in a round."""
    tol_step: float = 1e-4
    """A round has converged when no weight moves by more in a step."""
    tol_decrease: float = 1e-3
    """A round has converged when the loss falls by less, relatively."""
    max_iter: int = 25
    damping: float = 1e-4
    """First Marquardt factor, relative to the diagonal."""
    max_damping: float = 1e2

    def solve(
        self,
        level: WalkLevel,
        frames: MeasuredFrames,
        start: tuple[np.ndarray, WalkOptimum],
        progress: Progress | None = None,
    ) -> tuple[WalkLevel, WeightEstimate]:
        """Weights, and the level with the states that belong to them, from weights (n_theta,) and their optimum.

        `progress(iteration, rms)` may raise `errors.Cancelled`.
        """
        theta, optimum = start
        iterations, lower_iterations, settled = 0, 0, False
        run = _Run(self, frames, max(frames.noise, self.least_sigma), _State(level, theta, optimum), progress)
        for _ in range(self.rounds):
            run.search()
            iterations, lower_iterations = iterations + run.iterations, lower_iterations + run.lower_iterations
            moved = float(np.max(np.abs(run.state.theta - theta)))
            settled = run.converged and moved <= self.tol_round
            if settled or not run.converged:
                break
            run = run.renewed()
            theta = run.state.theta
        return run.state.level, run.estimate(settled, iterations, lower_iterations)


@dataclass(frozen=True, eq=False)
class _State:
    level: WalkLevel
    theta: np.ndarray
    """Weights, shape (n_theta,)."""
    optimum: WalkOptimum


@dataclass(frozen=True, eq=False)
class _Linearised:
    """Residuals divided by their standard deviations, and their derivatives."""

    r: np.ndarray
    """Measurements, then conditions of the floor, shape (n_m + n_c,)."""
    by_theta: np.ndarray
    """Derivatives in the weights, shape (n_m + n_c, n_theta)."""
    by_states: np.ndarray
    """Derivatives in the given states, shape (n_m + n_c, n_given * 2 n_q)."""
    moves: np.ndarray
    """Of (w, lam_g) with the weights and the two colours of states, shape (n_w + n_g, n_theta + 4 n_q)."""


@dataclass
class _Run:
    """One round: fixed normalisers and standard deviations."""

    method: JointSearch
    frames: MeasuredFrames
    sigma: float
    """Standard deviation of a marker's coordinate [m]."""
    state: _State
    progress: Progress | None
    damping: float = field(init=False)
    converged: bool = False
    iterations: int = 0
    lower_iterations: int = 0

    def __post_init__(self) -> None:
        level, method = self.state.level, self.method
        self.damping = method.damping
        self.table = sampling_table(level.tracked.stride.times, self.frames.times)  # (n_frames, N + 1, 2)
        self.conditions = StateConditions(
            structure=level.structure,
            p=level.tracked.problem.data.p,
            given_nodes=level.given_nodes,
            place=method.place,
            speed=method.speed,
        )

    def search(self) -> None:
        """Improve the state until the weights stay."""
        loss = self._loss(self.state)
        for _ in range(self.method.max_iter):
            self.iterations += 1
            if self.progress is not None:
                self.progress(self.iterations, float(np.sqrt(np.mean(self.misfit(self.state) ** 2))))
            lin = self._linearised()
            found, new = self._step(lin, loss)
            if found is None:
                # No step improves the fit any more: as good as it gets, if the steps are small.
                self.converged = new <= self.method.tol_step
                return
            moved = float(np.max(np.abs(found.theta - self.state.theta)))
            decrease = (loss - new) / loss
            self.state, loss = found, new
            if moved <= self.method.tol_step or decrease <= self.method.tol_decrease:
                self.converged = True
                return

    def misfit(self, state: _State) -> np.ndarray:
        """Optimal minus measured coordinates at the frames [m, rad], shape (n_frames, n_q)."""
        n_q = self.frames.q.shape[1]
        states = state.optimum.problem.states(state.optimum.solution.w).reshape(-1, 2, n_q)
        return np.einsum("fnj,njq->fq", self.table, states) - self.frames.q

    def _white(self, state: _State) -> np.ndarray:
        """The misfit as uncorrelated numbers with a standard deviation of one, shape (n_frames, n_q)."""
        return np.einsum("fij,fj->fi", self.frames.roots, self.misfit(state)) / self.sigma

    def _loss(self, state: _State) -> float:
        r, c = self._white(state), self.conditions.values(state.level.given)[0]
        return 0.5 * float(np.sum(r**2) + c @ c)

    def _linearised(self) -> _Linearised:
        state, n_q = self.state, self.frames.q.shape[1]
        level, optimum = state.level, state.optimum
        n_theta, n_nodes = level.n_theta, len(level.tracked.stride.times)
        moves = np.hstack([optimum.moves, optimum.moves_of_given])
        of_states = moves[: n_nodes * 2 * n_q].reshape(n_nodes, 2 * n_q, -1)
        spread = spread_moves(of_states[:, :, n_theta:], level.given_nodes).reshape(n_nodes, 2, n_q, -1)
        own = of_states[:, :, :n_theta].reshape(n_nodes, 2, n_q, -1)
        sampled = np.tensordot(self.table, np.concatenate([own, spread], axis=3), axes=([1, 2], [0, 1]))
        scaled = (self.frames.roots @ sampled / self.sigma).reshape(-1, sampled.shape[2])
        c, by_given = self.conditions.values(level.given)
        return _Linearised(
            r=np.concatenate([self._white(state).ravel(), c]),
            by_theta=np.vstack([scaled[:, :n_theta], np.zeros((len(c), n_theta))]),
            by_states=np.vstack([scaled[:, n_theta:], by_given.reshape(len(c), -1)]),
            moves=moves,
        )

    def _step(self, lin: _Linearised, loss: float) -> tuple[_State | None, float]:
        """A better state and its loss, or None and the size of the last step in the weights that was tried."""
        size = np.inf
        while self.damping <= self.method.max_damping:
            theta, given_step = self._subproblem(lin)
            size = float(np.max(np.abs(theta - self.state.theta)))
            trial = self._moved(lin, theta, given_step)
            if trial.optimum.solution.status is Status.SOLVED:
                new = self._loss(trial)
                if new < loss:
                    self.damping = max(self.damping / 5.0, 1e-9)
                    return trial, new
            self.damping *= 10.0
        return None, size

    def _subproblem(self, lin: _Linearised) -> tuple[np.ndarray, np.ndarray]:
        """Weights and the step of the given states, (n_theta,) and (n_given, 2 n_q), that minimise the damped model."""
        a, b = lin.by_theta, lin.by_states
        inner = b.T @ b
        inner[np.diag_indices_from(inner)] *= 1.0 + self.damping
        factors = cho_factor(inner)
        mixed, pull = b.T @ a, b.T @ lin.r
        outer = a.T @ a
        outer[np.diag_indices_from(outer)] *= 1.0 + self.damping
        hessian = outer - mixed.T @ cho_solve(factors, mixed)
        gradient = a.T @ lin.r - mixed.T @ cho_solve(factors, pull)
        theta = simplex_minimiser(self.state.theta, gradient, hessian)
        step = -cho_solve(factors, pull + mixed @ (theta - self.state.theta))
        return theta, step.reshape(self.state.level.given.shape)

    def _moved(self, lin: _Linearised, theta: np.ndarray, step: np.ndarray) -> _State:
        level = self.state.level.with_given(self.state.level.given + step)
        start = self._predicted(lin.moves, theta - self.state.theta, step)
        optimum = level.respond_nearby(theta, start)
        self.lower_iterations += optimum.solution.iterations
        return _State(level, theta, optimum)

    def _predicted(self, moves: np.ndarray, theta_step: np.ndarray, step: np.ndarray) -> SparseSolution:
        """First-order prediction, arc by arc: each follows its own two given states."""
        level = self.state.level
        n_w, direction = level.structure.n_w, np.zeros(len(moves))
        for k, arc in enumerate(level.arcs.parts):
            even, odd = (k, k + 1) if k % 2 == 0 else (k + 1, k)
            both = np.concatenate([theta_step, step[even], step[odd]])
            places = np.concatenate([arc.w, n_w + arc.g])
            direction[places] = moves[places] @ both
        return self.state.optimum.sensitivity.predict(direction)

    def renewed(self) -> "_Run":
        """The next round: normalisers and standard deviations of the state that was found."""
        level, theta = self.state.level.normalised_at(self.state.optimum, self.state.theta)
        freedom = 1.0 - self.state.level.given.size / self.frames.q.size
        sigma = self.sigma * float(np.sqrt(np.mean(self._white(self.state) ** 2) / max(freedom, 0.1)))
        optimum = level.respond(theta, self.state.optimum.solution)
        return _Run(
            self.method,
            self.frames,
            max(sigma, self.method.least_sigma),
            _State(level, theta, optimum),
            self.progress,
        )

    def estimate(self, settled: bool, iterations: int, lower_iterations: int) -> WeightEstimate:
        """The result, with the marginal covariance of the weights."""
        lin, white = self._linearised(), self._white(self.state)
        basis = qr(lin.by_states, mode="economic")[0]
        marginal = lin.by_theta - basis @ (basis.T @ lin.by_theta)
        # The states between arcs take degrees of freedom.
        freedom = max(1.0 - self.state.level.given.size / white.size, 0.1)
        uncertainty = weight_uncertainty(marginal, white / np.sqrt(freedom))
        reason = "converged: weights, states and normalisers stay" if settled else "weights and states do not settle"
        return WeightEstimate(
            theta=self.state.theta,
            response=self.state.optimum,
            covariance=uncertainty.covariance,
            identifiable=uncertainty.identifiable,
            condition=uncertainty.condition,
            converged=settled,
            reason=reason,
            iterations=iterations,
            lower_iterations=lower_iterations,
        )
