"""Why this stride looks as it does: tracking, the pure optimal control problem, and the weights that fit best."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from time import perf_counter

import numpy as np

from ..bilevel.implicit_gauss_newton import ImplicitGaussNewton
from ..bilevel.result import WeightEstimate, rms
from ..errors import NotConverged
from ..nlp.sparse_solution import Status
from ..nlp.workers import Workers, results_of
from .identification import IdentificationSettings, WalkLevel, WalkOptimum
from .joint_search import JointSearch, MeasuredFrames, closer_stride
from .tracking import MeasuredStride, TrackedWalk, TrackingSettings, track

CERTIFICATE = 1e-6
"""Largest first-order residual of an accepted solution."""

SECOND_LOOKS = 3
"""How often the search goes on from a better optimum found at its end."""

Report = Callable[[str, int, float], None]
"""Called with the stage in words, the iteration and its residual (not a number where a stage counts arcs solved);
cancels by raising `errors.Cancelled`."""

FramesOfStride = Callable[[], MeasuredFrames]
"""Gives the unsmoothed frames of a stride; called only where the search needs them, as few walks do."""


@dataclass(frozen=True, kw_only=True)
class ExplanationSettings:
    """Settings of the three steps."""

    tracking: TrackingSettings = field(default_factory=TrackingSettings)
    identification: IdentificationSettings = field(default_factory=IdentificationSettings)
    method: ImplicitGaussNewton = field(default_factory=ImplicitGaussNewton)
    joint: JointSearch = field(default_factory=JointSearch)
    explained_within: float = 0.008
    """A walk tracked closer than this [rad, m] is explained to within its noise: then the states between arcs are
    estimated together with the weights. Real walks so far: 0.016 to 0.027."""
    single_criteria: bool = True
    """Whether to solve for each criterion alone: what the weights must beat, and further starts of the search."""


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """A stride, its optimal counterpart, and what other weights would have given."""

    tracked: TrackedWalk
    level: WalkLevel
    optimum: WalkOptimum
    estimate: WeightEstimate
    equal_rms: float | None
    """Fit of equal weights; None where that problem was not solved."""
    single_rms: Mapping[str, float | None]
    """Fit of each criterion alone; empty where it was not asked for."""
    states_estimated: bool = False
    """Whether the states between arcs were estimated with the weights; else they are those of the tracked walk."""
    tracking_seconds: float | None = None
    """Time that the tracking took [s]; None where it was done before."""

    @property
    def is_certified(self) -> bool:
        """First-order conditions to 1e-6, a minimum to second order, and a converged upper level."""
        solution = self.optimum.solution
        return solution.is_optimal(CERTIFICATE) and self.optimum.sensitivity.is_minimum() and self.estimate.converged


def explain(
    stride: MeasuredStride,
    settings: ExplanationSettings | None = None,
    report: Report | None = None,
    workers: Workers | None = None,
    frames: FramesOfStride | None = None,
) -> Explanation:
    """Track a stride and find the weights of its criteria, on one processor or with the help of workers.

    With the stride's unsmoothed frames, the states between arcs can be estimated, see `joint_search`.

    Raises:
        NotConverged: the tracking problem or the optimal control problem with equal weights was not solved.
    """
    settings = settings or ExplanationSettings()
    begin = perf_counter()
    tracked = track(stride, settings.tracking, _part(report, "tracking"))
    seconds = perf_counter() - begin
    _require(tracked.solution.status, "tracking the measured stride", tracked.solution.iterations)
    return replace(explain_tracked(tracked, settings, report, workers, frames), tracking_seconds=seconds)


def explain_tracked(
    tracked: TrackedWalk,
    settings: ExplanationSettings | None = None,
    report: Report | None = None,
    workers: Workers | None = None,
    frames: FramesOfStride | None = None,
) -> Explanation:
    """Find the weights of the criteria of a tracked stride. Raises `errors.NotConverged` as `explain` does."""
    settings = settings or ExplanationSettings()
    if frames is not None and tracked.rms <= settings.explained_within:
        found = _explain_with_states(tracked, frames(), settings, report, workers)
        if found is not None:
            return found
    level = WalkLevel(tracked, settings.identification, workers)
    theta, equal = _equal_weights(level, report)
    singles = single_criteria(level, equal, report) if settings.single_criteria else []
    candidates = [(theta, equal), *((vertex, r) for vertex, r in singles if _solved(r))]
    best = min(candidates, key=lambda candidate: rms(candidate[1].residual))
    # The loss has several minima: the middle of the simplex is tried even where a corner fits better at first.
    starts = [best] if best is candidates[0] else [best, candidates[0]]
    estimates = results_of([partial(_search, level, settings.method, start, report) for start in starts], workers)
    estimate = min(estimates, key=lambda found: found.rms)
    return _explanation(level, estimate, equal, singles)


def _explain_with_states(
    tracked: TrackedWalk,
    frames: MeasuredFrames,
    settings: ExplanationSettings,
    report: Report | None,
    workers: Workers | None,
) -> Explanation | None:
    """Weights and states between arcs together; None where that does not converge."""
    stride = closer_stride(tracked.stride, frames)
    close = track(stride, settings.tracking, _part(report, "tracking with less smoothing"))
    if close.solution.status is not Status.SOLVED:
        return None
    level = WalkLevel(close, settings.identification, workers)
    equal_theta, response = _equal_weights(level, report)
    # Far from the right weights the response to steps of the states is too wild to follow.
    first = settings.method.solve(level, equal_theta, response, _part(report, "weights"))
    start = first.theta, WalkOptimum(level, level.problem(first.theta), first.response.solution)
    level, estimate = settings.joint.solve(level, frames, start, _part(report, "weights and states together"))
    if not estimate.converged:
        return None
    found = WalkOptimum(level, level.problem(estimate.theta), estimate.response.solution)
    equal = level.respond_from_afar(equal_theta, found.solution, _arcs(report, "equal weights"))
    singles = single_criteria(level, found, report) if settings.single_criteria else []
    return replace(_explanation(level, estimate, equal, singles), tracked=tracked, states_estimated=True)


def _equal_weights(level: WalkLevel, report: Report | None) -> tuple[np.ndarray, WalkOptimum]:
    theta = np.full(level.n_theta, 1.0 / level.n_theta)
    equal = level.from_tracking(theta, _arcs(report, "equal weights"))
    _require(equal.solution.status, "the optimal control problem without tracking", equal.solution.iterations)
    return theta, equal


def _explanation(
    level: WalkLevel, estimate: WeightEstimate, equal: WalkOptimum, singles: list[tuple[np.ndarray, WalkOptimum]]
) -> Explanation:
    return Explanation(
        tracked=level.tracked,
        level=level,
        optimum=WalkOptimum(level, level.problem(estimate.theta), estimate.response.solution),
        estimate=estimate,
        equal_rms=_fit(equal),
        single_rms={
            name: _fit(response) for name, (_, response) in zip(level.settings.criteria, singles, strict=False)
        },
    )


def _fit(response: WalkOptimum) -> float | None:
    return rms(response.residual) if _solved(response) else None


def _search(
    level: WalkLevel, method: ImplicitGaussNewton, start: tuple[np.ndarray, WalkOptimum], report: Report | None
) -> WeightEstimate:
    """Weights from a start, followed until no arc has a better optimum than the one that was followed there."""
    theta, response = start
    estimate = method.solve(level, theta, response, _part(report, "weights"))
    for _ in range(SECOND_LOOKS):
        found = WalkOptimum(level, level.problem(estimate.theta), estimate.response.solution)
        better = level.second_look(found, _arcs(report, "looking for better optima"))
        if better.solution.f >= found.solution.f:
            break
        estimate = method.solve(level, estimate.theta, better, _part(report, "weights"))
    return estimate


def single_criteria(
    level: WalkLevel, start: WalkOptimum, report: Report | None = None
) -> list[tuple[np.ndarray, WalkOptimum]]:
    """Optimal walks of each criterion alone, followed from a solved one: weights, shape (n_theta,), and response."""
    vertices = list(np.eye(level.n_theta))
    calls = [
        partial(level.respond_from_afar, vertex, start.solution, _arcs(report, f"only {name}"))
        for vertex, name in zip(vertices, level.settings.criteria, strict=True)
    ]
    return list(zip(vertices, results_of(calls, level.workers), strict=True))


def _solved(response: WalkOptimum) -> bool:
    return response.solution.status is Status.SOLVED


def _part(report: Report | None, stage: str) -> Callable[[int, float], None] | None:
    if report is None:
        return None
    return lambda iteration, residual: report(stage, iteration, residual)


def _arcs(report: Report | None, stage: str) -> Callable[[int], None] | None:
    if report is None:
        return None
    return lambda n_solved: report(stage, n_solved, float("nan"))


def _require(status: Status, what: str, iterations: int) -> None:
    if status is not Status.SOLVED:
        raise NotConverged(
            f"{what} did not converge: {status.value} after {iterations} iterations; "
            "check the events and the marker gaps of this stride, or choose another walk"
        )
