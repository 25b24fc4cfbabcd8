"""The published optimal control problems, solved forwards, confirmed on a finer grid, and inverted."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..benchmarks.definition import Benchmark
from ..bilevel.from_measurements import Estimated, inverse_problem
from ..bilevel.inverse_problem import InverseProblem
from ..bilevel.inverse_result import InverseResult
from ..nlp.ipopt import Ipopt
from ..ocp.measurement import Measurement
from ..ocp.trajectory import Trajectory
from ..transcription.optimal_control import OptimalControl, Solve
from ..transcription.transcribed import Transcribed
from .inverse_methods import inverse_method

SOLVE = Solve(solver=Ipopt(tol=1e-10))
SAMPLES = 8
"""Per interval, of trajectories to draw."""
AGREEMENT = 1e-5
"""Relative difference up to which the finer collocation confirms an optimum."""


@dataclass(frozen=True, kw_only=True)
class Forward:
    """The optimal control problem of a benchmark, solved for the true parameters."""

    benchmark: Benchmark
    transcribed: Transcribed
    result: OptimalControl
    seconds: float
    """Of the solve [s]."""
    finer: OptimalControl
    """The same problem by an independent, finer collocation."""

    @property
    def course(self) -> Trajectory:
        """The optimum, sampled finely enough to draw."""
        return self.transcribed.trajectory(self.result.solution.w, self.benchmark.truth, SAMPLES)

    @property
    def difference(self) -> float:
        """Relative difference of both optima."""
        f = self.result.solution.f
        return abs(self.finer.solution.f - f) / abs(f)

    @property
    def confirmed(self) -> bool:
        """Whether the optimum is certified and both discretisations agree."""
        certified = self.result.converged and self.result.minimum and self.finer.converged
        return certified and self.difference <= AGREEMENT


@dataclass(frozen=True, kw_only=True)
class Inverse:
    """The inverse problem of a benchmark, solved by one method."""

    method: str
    result: InverseResult
    course: Trajectory
    """The estimate, sampled finely enough to draw."""
    cold_seconds: float
    """Of the first solve [s]."""
    warm_seconds: float
    """Of a repeated solve [s]; of the first where it was long."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison:
    """One benchmark with all methods."""

    forward: Forward
    measurements: tuple[Measurement, ...]
    inverses: tuple[Inverse, ...]


LONG = 5.0
"""Solves longer than this are not repeated [s]."""


def compare(benchmark: Benchmark, methods: Sequence[str]) -> Comparison:
    """Solve a benchmark forwards, and backwards by each method.

    Raises:
        NotFound: There is no method of some name.
    """
    for name in methods:
        inverse_method(name)
    forward = solve_forward(benchmark)
    measurements = benchmark.simulate(forward.transcribed, forward.result.solution.w)
    inverses = tuple(solve_inverse(forward, measurements, methods))
    return Comparison(forward=forward, measurements=measurements, inverses=inverses)


def solve_forward(benchmark: Benchmark) -> Forward:
    """Solve the optimal control problem twice, on the published grid and by a finer collocation."""
    transcribed = benchmark.transcribe()
    began = time.perf_counter()
    result = SOLVE(transcribed, benchmark.start, benchmark.truth)
    seconds = time.perf_counter() - began
    near = transcribed.trajectory(result.solution.w, benchmark.truth, SAMPLES)
    finer = SOLVE(benchmark.finer(), near, benchmark.truth)
    return Forward(benchmark=benchmark, transcribed=transcribed, result=result, seconds=seconds, finer=finer)


def pose_inverse(
    forward: Forward, measurements: Sequence[Measurement]
) -> tuple[InverseProblem, np.ndarray, np.ndarray]:
    """Inverse problem with its published start: the optimum for guessed parameters, w of shape (n_w,), p (n_p,)."""
    benchmark, unknowns = forward.benchmark, forward.benchmark.unknowns
    estimated = Estimated(names=unknowns.names, lower=unknowns.lower, upper=unknowns.upper)
    problem = inverse_problem(forward.transcribed, measurements, estimated, benchmark.truth)
    p0 = benchmark.truth.copy()
    p0[[benchmark.problem.parameter_index(name) for name in unknowns.names]] = unknowns.guess
    guess = SOLVE(forward.transcribed, forward.result.trajectory, p0)
    return problem, guess.solution.w, p0


def solve_inverse(forward: Forward, measurements: Sequence[Measurement], methods: Sequence[str]) -> Iterator[Inverse]:
    """Estimate by each method from the same start."""
    problem, w0, p0 = pose_inverse(forward, measurements)
    for name in methods:
        method = inverse_method(name)
        began = time.perf_counter()
        result = method.solve(problem, w0, p0)
        cold = warm = time.perf_counter() - began
        if cold < LONG:
            began = time.perf_counter()
            method.solve(problem, w0, p0)
            warm = time.perf_counter() - began
        yield Inverse(
            method=name,
            result=result,
            course=forward.transcribed.trajectory(result.w, result.p, SAMPLES),
            cold_seconds=cold,
            warm_seconds=warm,
        )
