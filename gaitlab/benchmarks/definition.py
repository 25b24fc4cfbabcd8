"""What a published problem of hierarchical dynamic optimisation consists of."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..nlp.ipopt import Ipopt
from ..nlp.solution import NLPSolution
from ..ocp.measurement import Measurement
from ..ocp.problem import MultiStageProblem
from ..ocp.trajectory import Trajectory
from ..transcription.collocation import DirectCollocation
from ..transcription.multiple_shooting import MultipleShooting
from ..transcription.transcribed import Transcribed


@dataclass(frozen=True, kw_only=True)
class PublishedOptimum:
    """What the source prints of the optimal control problem."""

    duration: float
    """Optimal control value q_0 [s]."""
    objective: float | None
    remark: str
    """Difference to our certified optimum, explained, or said to be not reproduced."""


@dataclass(frozen=True, kw_only=True)
class PublishedEstimate:
    """What the source prints of the inverse problem."""

    estimates: Mapping[str, float]
    """Estimated weights and parameters by name."""
    objective: float
    duration: float | None
    seconds: float | None
    """Of the all-at-once approach [s]."""
    iterations: int
    other_seconds: Mapping[str, float] = field(default_factory=dict[str, float])
    """Of other methods, under our names for them [s]."""

    remark: str = "its noise is not published"

    def seconds_of(self, method: str) -> float | None:
        """Published time to compare a method with: its own, else that of the all-at-once approach [s]."""
        return self.other_seconds.get(method, self.seconds)


@dataclass(frozen=True, kw_only=True, eq=False)
class Observation:
    """What is measured in the inverse problem."""

    name: str
    function: ca.SX
    """Of the first stage's (t, x, u), shape (n_h, 1)."""
    times: np.ndarray
    """Fractions of the stage, shape (n_t,)."""
    sd: np.ndarray
    """Standard deviation of the noise, shape (n_h,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Unknowns:
    """Weights and parameters that the inverse problem estimates."""

    names: tuple[str, ...]
    guess: np.ndarray
    """Start of the estimation, as published, shape (n,)."""
    lower: np.ndarray
    """Lower bounds, shape (n,)."""
    upper: np.ndarray
    """Upper bounds, shape (n,); the sources have none: ours are wide and inactive."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Benchmark:
    """A published optimal control problem and its inverse problem."""

    name: str
    title: str
    source: str
    """Equations and tables, and the readings chosen where the source contradicts itself."""
    problem: MultiStageProblem
    method: MultipleShooting
    """The source's grid and control shape, integrated more finely."""
    truth: np.ndarray
    """True (theta, p), shape (n_p,)."""
    start: Trajectory
    """Start of the solver for the optimal control problem."""
    observations: tuple[Observation, ...]
    unknowns: Unknowns
    published: PublishedOptimum
    published_estimate: PublishedEstimate
    seed: int = 2014
    """Of the simulated noise."""

    @property
    def n_intervals(self) -> int:
        """Intervals of the published grid."""
        if not isinstance(self.method.grids, int):
            raise ProblemError(f"benchmark '{self.name}' must have one number of intervals")
        return self.method.grids

    def transcribe(self) -> Transcribed:
        """Discretise as published."""
        return self.method.transcribe(self.problem)

    def finer(self) -> Transcribed:
        """Discretise the same controls and bounds independently: collocation of degree 5, four elements an interval.

        States are bounded at the published nodes only, so both discretisations approximate the same problem.
        """
        method = DirectCollocation(grids=self.n_intervals, degree=5, n_elements=self.finer_elements, bound_inside=False)
        return method.transcribe(self.problem)

    @property
    def finer_elements(self) -> int:
        """Elements per interval of the confirmation; long intervals need more."""
        return 1 if self.n_intervals >= 50 else 2

    def solve(self, transcribed: Transcribed, solver: Ipopt, start: np.ndarray | None = None) -> NLPSolution:
        """Solve the optimal control problem for the true parameters, from w of shape (n_w,) or the published start."""
        w0 = transcribed.start(self.start) if start is None else start
        return solver.solve(transcribed.nlp, w0, self.truth)

    def simulate(self, transcribed: Transcribed, w: np.ndarray) -> tuple[Measurement, ...]:
        """Noisy measurements of the solution w, shape (n_w,), reproducible by the seed."""
        noise = np.random.default_rng(self.seed)
        return tuple(self._measure(observation, transcribed, w, noise) for observation in self.observations)

    def _measure(
        self, observation: Observation, transcribed: Transcribed, w: np.ndarray, noise: np.random.Generator
    ) -> Measurement:
        sd = np.tile(observation.sd, (observation.times.size, 1))
        blank = Measurement(
            name=observation.name,
            function=observation.function,
            times=observation.times,
            sd=sd,
            values=np.zeros_like(sd),
        )
        nlp = transcribed.nlp
        exact = np.asarray(ca.Function("h", [nlp.w, nlp.p], [transcribed.response(blank)])(w, self.truth).full())
        return Measurement(
            name=observation.name,
            function=observation.function,
            times=observation.times,
            sd=sd,
            values=exact + noise.normal(size=sd.shape) * sd,
        )
