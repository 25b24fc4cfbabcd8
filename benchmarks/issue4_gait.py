"""Issue 4: the thesis's gait models at full size: time, linear cost, weights recovered, coverage, random starts."""

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context

import numpy as np
from registry import Row, measurement
from scipy.interpolate import CubicHermiteSpline

from gaitlab.errors import NotConverged
from gaitlab.nlp.sensitivity import Sensitivity
from gaitlab.nlp.workers import worker_pool
from gaitlab.pipelines.gait_benchmark import solve_case
from gaitlab.pipelines.gait_cases import GaitCase, available_cases, load_case
from gaitlab.walking.gait_data import MeasuredGait
from gaitlab.walking.point_foot_gait import GaitLevel

SEEDS = 50
SIZES = (31, 62, 124, 248, 496, 992)
LIMITS = {"cp-child": "<= 10", "able-bodied-child": "<= 20"}
COVERED = 43
"""Fewest of 50 intervals of 95 % that a binomial distribution allows with 99 % (two-sided; the most is 50)."""


@measurement(issue=4, line=1)
def thesis_gait_seconds() -> Iterator[Row]:
    for name in available_cases():
        with worker_pool() as workers:
            first, *warm = [solve_case(load_case(name), 1.0, 0, workers=workers) for _ in range(4)]
        run = sorted(warm, key=lambda run: run.seconds)[1]
        yield Row(quantity="first in new processes", value=first.seconds, limit="<= 30", unit="s", subject=name)
        yield Row(quantity="warm, median of three", value=run.seconds, limit=LIMITS[name], unit="s", subject=name)
        speed_up = run.case.thesis.seconds / run.seconds
        yield Row(quantity="thesis's time over ours", value=speed_up, limit="", unit="", subject=name)


@measurement(issue=4, line=3)
def thesis_gait_linear_time() -> Iterator[Row]:
    seconds = [_iteration(load_case("cp-child"), n) for n in SIZES]
    for n, value in zip(SIZES, seconds, strict=True):
        yield Row(quantity=f"one iteration, {n} intervals", value=value, limit="", unit="s", subject="cp-child")
    exponent = float(np.polyfit(np.log(SIZES), np.log(seconds), 1)[0])
    yield Row(quantity="exponent", value=exponent, limit="<= 1.1", unit="", subject="cp-child")


@measurement(issue=4, line=4)
def thesis_gait_without_noise() -> Iterator[Row]:
    for name in available_cases():
        run = solve_case(load_case(name))
        yield Row(quantity="largest error of a weight", value=run.error, limit="<= 0.01", unit="", subject=name)
        yield Row(quantity="not certified", value=float(not run.certified), limit="<= 0", unit="", subject=name)


@measurement(issue=4, line=4)
def thesis_gait_coverage() -> Iterator[Row]:
    for name in available_cases():
        runs = [run for run in _all(partial(_noisy, name)) if run is not None]
        covered, deviation = sum(run.covered for run in runs), float(np.median([run.deviation for run in runs]))
        yield Row(quantity="certified", value=len(runs), limit="", unit="of 50", subject=name)
        yield Row(quantity="95 % ellipsoids", value=covered, limit=f">= {COVERED}", unit="of 50", subject=name)
        yield Row(quantity="median sd", value=deviation, limit="<= 0.05", unit="", subject=name)


@measurement(issue=4, line=4)
def thesis_gait_random_starts() -> Iterator[Row]:
    for name in available_cases():
        grid = solve_case(load_case(name)).estimate.rms
        runs = [run for run in _all(partial(_random, name)) if run is not None]
        best = sum(run.rms * run.noise < 1.1 * np.hypot(run.noise, grid) for run in runs)
        yield Row(quantity="misfit without noise", value=grid, limit="", unit="units of noise", subject=name)
        yield Row(quantity="certified, sigma to 2 deg", value=len(runs), limit=">= 48", unit="of 50", subject=name)
        yield Row(quantity="of them no worse fit than noise", value=best, limit=">= 48", unit="of 50", subject=name)


@dataclass(frozen=True, kw_only=True)
class _Certified:
    """What a certified run tells."""

    noise: float
    """In units of 1 degree and 10 mm."""
    covered: bool
    deviation: float
    """Largest standard deviation of a weight."""
    rms: float
    """Of the residual in standard deviations of the noise."""


def _all(run: Callable[[int], _Certified | None]) -> list[_Certified | None]:
    """A run for each seed, on two processors."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        return list(pool.map(run, range(SEEDS)))


def _noisy(name: str, seed: int) -> _Certified | None:
    return _tried(load_case(name), 1.0, seed)


def _random(name: str, seed: int) -> _Certified | None:
    """Random weights to start from, and noise of up to 2 degrees and 20 mm."""
    generator = np.random.default_rng(1000 + seed)
    start = generator.dirichlet(np.ones(4))
    return _tried(load_case(name), 2.0 * generator.random(), seed, start)


def _tried(case: GaitCase, noise: float, seed: int, start: np.ndarray | None = None) -> _Certified | None:
    try:
        run = solve_case(case, noise, seed, start)
    except NotConverged:
        return None
    if not run.certified:
        return None
    deviation = float(np.sqrt(np.diag(run.estimate.covariance)).max())
    return _Certified(noise=noise, covered=run.covers_truth(), deviation=deviation, rms=run.estimate.rms)


def _iteration(case: GaitCase, n: int) -> float:
    """Least processor time of an iteration of the lower level on a grid of n intervals [s].

    Derivatives, inertia, factorisation and solution of the KKT system, once each.
    """
    level = _regridded(case, n)
    start = level.at_start(np.full(4, 0.25))
    seconds = list[float]()
    for _ in range(4):
        began = time.process_time()
        for problem, x in zip(start.problems, start.solutions, strict=True):
            sensitivity = Sensitivity(problem, x)
            sensitivity.is_minimum()
            sensitivity.of_objective(np.ones((problem.structure.n_w, 1)))
        seconds.append(time.process_time() - began)
    return min(seconds[1:])


def _regridded(case: GaitCase, n: int) -> GaitLevel:
    """The smoothed measurements on another grid, stages in their proportion."""
    shares = np.array(case.gait.n_intervals) / sum(case.gait.n_intervals)
    sizes = [int(k) for k in np.round(shares * n)]
    sizes[1] += n - sum(sizes)
    n_q, states = case.gait.subject.n_q, list[np.ndarray]()
    guess = GaitLevel(case.gait, case.measured(0.0, 0)).first
    for x, duration, k in zip(guess, case.gait.durations, sizes, strict=True):
        spline = CubicHermiteSpline(np.linspace(0.0, duration, len(x)), x[:, :n_q], x[:, n_q:])
        times = np.linspace(0.0, duration, k + 1)
        states.append(np.hstack([spline(times), spline(times, 1)]))
    gait = replace(case.gait, n_intervals=(sizes[0], sizes[1], sizes[2]))
    measured = MeasuredGait(q=tuple(x[:, :n_q] for x in states), deviation=case.measured(1.0, 0).deviation)
    return GaitLevel(gait, measured, first=tuple(states))
