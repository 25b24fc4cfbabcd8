r"""The weights together with the states between the arcs, from every measured frame.

`identification` gives the states between arcs as tracked. Where the model explains a walk to within the noise of its
measurement, errors of these states are what spoils the weights: tracking smooths them, and at changes of contact
velocities bend within a few milliseconds. Then they are unknowns like the weights:

.. math:: \min_{\theta, X} \; \tfrac1{2 \sigma^2} \sum_t (q^*_t - \hat q_t)' G_t (q^*_t - \hat q_t)
          + \tfrac12 |c(X)|^2, \qquad \theta \ge 0, \; \sum \theta = 1,

with all given states X, the optimal arcs q*(theta, X) between them, coordinates of single frames and what their markers
tell of them, G = J'J (to first order these are the markers' own distances), and the conditions c of planted feet.
Gauss-Newton with Marquardt's damping, see `node_damping`; X is eliminated from each step, and the covariance of the
weights is the marginal one. The criteria are divided by their values on the estimated optimum itself, less what noise
adds to them, and sigma is the markers' own misfit: both are renewed until they stay.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import cho_factor, cho_solve, null_space, qr, solve_triangular

from ..bilevel.result import WeightEstimate
from ..bilevel.simplex_step import simplex_minimiser
from ..bilevel.uncertainty import Uncertainty, weight_uncertainty
from ..nlp.sparse_solution import SparseSolution, Status
from .given_states import StateConditions, sampling_table, spread_moves
from .identification import WalkLevel, WalkOptimum
from .node_damping import NodeDamping
from .tracking import MeasuredStride

Progress = Callable[[int, float], None]

FIRST = 10.0
"""How much coarser the first round ends."""
SMALL = 0.1
"""Part of its standard deviation by which a weight may move in the last round."""


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
    """Ended when no weight moves by more in a round, beyond a tenth of its standard deviation."""
    tol_loss: float = 0.1
    """A round has converged when a step promises less; a change of the negative log likelihood by 0.5 is a standard
    deviation."""
    tol_step: float = 1e-4
    """It has also converged where no step helps and none tried would move a weight by more."""
    max_iter: int = 40
    attempts: int = 8
    """Steps tried in an iteration, each held back more."""
    posture: float = 0.01
    """Step of a given coordinate that a damping of one holds back [m, rad]."""
    velocity: float = 0.3
    """The same of its velocity [m/s, rad/s]."""
    least_damping: float = 0.03
    draws: int = 20
    """Pairs of walks drawn from what the estimate leaves open, for the noise in its normalisers."""

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
        damping = NodeDamping(
            scale=np.repeat([self.posture, self.velocity], level.given.shape[1] // 2),
            factors=np.ones(len(level.given)),
            least=self.least_damping,
        )
        sigma = max(frames.noise, self.least_sigma)
        run = _Run(self, frames, sigma, _State(level, theta, optimum), damping, progress)
        settled = False
        for k in range(self.rounds):
            before = run.state.theta
            # Normalisers of the first round are those of the start: it need not end exactly.
            run.search(self.tol_loss if k else FIRST * self.tol_loss)
            settled = run.converged and run.has_stayed_at(before)
            if settled or not run.converged:
                break
            run = run.renewed()
        return run.state.level, run.estimate(settled)


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
    damping: NodeDamping
    progress: Progress | None
    loss: float = field(init=False)
    known: tuple[_State, _Linearised] | None = field(default=None, init=False)
    """The newest linearisation, and where."""
    converged: bool = False
    iterations: int = 0
    """Of all rounds so far."""
    lower_iterations: int = 0

    def __post_init__(self) -> None:
        level, method = self.state.level, self.method
        self.table = sampling_table(level.tracked.stride.times, self.frames.times)  # (n_frames, N + 1, 2)
        self.conditions = StateConditions(
            structure=level.structure,
            p=level.tracked.problem.data.p,
            given_nodes=level.given_nodes,
            place=method.place,
            speed=method.speed,
        )
        self.loss = self._loss(self.state)

    def search(self, tol_loss: float) -> None:
        """Improve the state until no step promises more than `tol_loss`."""
        for _ in range(self.method.max_iter):
            self.iterations += 1
            if self.progress is not None:
                self.progress(self.iterations, float(np.sqrt(np.mean(self.misfit(self.state) ** 2))))
            if not self._takes_step(self._linearised(), tol_loss):
                return

    def _takes_step(self, lin: _Linearised, tol_loss: float) -> bool:
        """Take a step that lowers the loss; false if there is none."""
        surprised, size = np.zeros(len(self.state.level.given) - 1, dtype=bool), np.inf
        for attempt in range(self.method.attempts):
            theta, given_step = self._subproblem(lin)
            size = float(np.max(np.abs(theta - self.state.theta)))
            expected = lin.r + lin.by_theta @ (theta - self.state.theta) + lin.by_states @ given_step.ravel()
            promised = self.loss - 0.5 * float(expected @ expected)
            if attempt == 0 and promised <= tol_loss:
                self.converged = True
                return False
            trial = self._moved(lin, theta, given_step)
            # An arc that was not solved ends far from where it was expected.
            now = self._worse_than(expected, trial) > 0.25 * max(promised, tol_loss)
            new = self._loss(trial)
            if trial.optimum.solution.status is Status.SOLVED and new < self.loss:
                self.damping.ease(surprised | now)
                self.state, self.loss = trial, new
                return True
            self.damping.hold(now, attempt)
            surprised |= now
        self.converged = size <= self.method.tol_step
        return False

    def _worse_than(self, expected: np.ndarray, trial: _State) -> np.ndarray:
        """How much worse each arc fits than expected from residuals (n_m + n_c,), shape (n_given - 1,)."""
        level, n_arcs = trial.level, len(trial.level.given) - 1
        starts = level.tracked.stride.times[level.given_nodes]
        arc = np.clip(np.searchsorted(starts, self.frames.times, side="right") - 1, 0, n_arcs - 1)
        white = self._white(trial)
        excess = 0.5 * np.sum(white**2 - expected[: white.size].reshape(white.shape) ** 2, axis=1)
        return np.bincount(arc, excess, n_arcs)

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
        if self.known is None or self.known[0] is not self.state:
            self.known = self.state, self._linearise()
        return self.known[1]

    def _linearise(self) -> _Linearised:
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

    def _subproblem(self, lin: _Linearised) -> tuple[np.ndarray, np.ndarray]:
        """Weights and the step of the given states, (n_theta,) and (n_given, 2 n_q), that minimise the damped model."""
        a, b = lin.by_theta, lin.by_states
        inner = b.T @ b
        inner[np.diag_indices_from(inner)] += self.damping.diagonal
        factors = cho_factor(inner)
        mixed, pull = b.T @ a, b.T @ lin.r
        hessian = a.T @ a - mixed.T @ cho_solve(factors, mixed)
        gradient = a.T @ lin.r - mixed.T @ cho_solve(factors, pull)
        theta = simplex_minimiser(self.state.theta, gradient, hessian)
        step = -cho_solve(factors, pull + mixed @ (theta - self.state.theta))
        return theta, step.reshape(self.state.level.given.shape)

    def _moved(self, lin: _Linearised, theta: np.ndarray, step: np.ndarray) -> _State:
        level = self.state.level.with_given(self.state.level.given + step)
        start = self._predicted(lin.moves, theta - self.state.theta, step)
        trial = _State(level, theta, level.respond_nearby(theta, start))
        self.lower_iterations += trial.optimum.solution.iterations
        if trial.optimum.solution.status is not Status.SOLVED and self._loss(trial) < self.loss:
            # Unfinished, but worth pursuing.
            trial = _State(level, theta, level.respond(theta, start))
            self.lower_iterations += trial.optimum.solution.iterations
        return trial

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
        level, theta = self.state.level.normalised_at(self.state.optimum, self.state.theta, self._inflation())
        freedom = 1.0 - self.state.level.given.size / self.frames.q.size
        sigma = self.sigma * float(np.sqrt(np.mean(self._white(self.state) ** 2) / max(freedom, 0.1)))
        optimum = level.respond(theta, self.state.optimum.solution)
        return _Run(
            self.method,
            self.frames,
            max(sigma, self.method.least_sigma),
            _State(level, theta, optimum),
            self.damping,
            self.progress,
            iterations=self.iterations,
            lower_iterations=self.lower_iterations,
        )

    def _inflation(self) -> np.ndarray:
        """What the noise adds to the normalisers on average, to second order; as `WalkLevel.normaliser_values`.

        Criteria are sums of squares, so that errors of the given states make them larger: by a quarter for the floor of
        accelerations of a demo walk at 0.5 mm. Mean over pairs of walks on both sides of the estimate, drawn from its
        covariance.
        """
        lin, state, damping = self._linearised(), self.state, self.damping
        tangent = null_space(np.ones((1, state.level.n_theta)))
        bound = np.sqrt(damping.least) / np.tile(damping.scale, len(state.level.given))
        n_t = tangent.shape[1]
        rows = np.vstack([np.hstack([lin.by_theta @ tangent, lin.by_states]), np.eye(n_t + bound.size)[n_t:]])
        rows[len(lin.r) :, n_t:] *= bound
        root = qr(rows, mode="r")[0][: rows.shape[1]]
        draws = solve_triangular(root, np.random.default_rng(0).standard_normal((rows.shape[1], self.method.draws)))
        middle = state.level.normaliser_values(state.optimum.problem, state.optimum.solution.w)
        both = [
            state.level.normaliser_values(state.optimum.problem, self._predicted(lin.moves, *each).w)
            for draw in draws.T
            for sign in (1.0, -1.0)
            for each in [(sign * tangent @ draw[:n_t], sign * draw[n_t:].reshape(state.level.given.shape))]
        ]
        return np.mean(both, axis=0) - middle

    def has_stayed_at(self, theta: np.ndarray) -> bool:
        """Whether the weights have moved by little from theta, shape (n_theta,)."""
        allowed = self.method.tol_round + SMALL * np.sqrt(np.diag(self._uncertainty().covariance))
        return bool(np.all(np.abs(self.state.theta - theta) <= allowed))

    def _uncertainty(self) -> Uncertainty:
        """Marginal covariance of the weights, the states being unknown, too."""
        lin, white = self._linearised(), self._white(self.state)
        basis = qr(lin.by_states, mode="economic")[0]
        marginal = lin.by_theta - basis @ (basis.T @ lin.by_theta)
        # The states between arcs take degrees of freedom.
        freedom = max(1.0 - self.state.level.given.size / white.size, 0.1)
        return weight_uncertainty(marginal, white / np.sqrt(freedom))

    def estimate(self, settled: bool) -> WeightEstimate:
        """The result, and whether it has settled."""
        uncertainty = self._uncertainty()
        reason = "converged: weights, states and normalisers stay" if settled else "weights and states do not settle"
        return WeightEstimate(
            theta=self.state.theta,
            response=self.state.optimum,
            covariance=uncertainty.covariance,
            identifiable=uncertainty.identifiable,
            condition=uncertainty.condition,
            converged=settled,
            reason=reason,
            iterations=self.iterations,
            lower_iterations=self.lower_iterations,
        )
