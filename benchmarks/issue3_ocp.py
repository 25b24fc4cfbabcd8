"""Issue 3: optima confirmed by a finer collocation, inverse problems by the fast path and by every method."""

import time
from collections.abc import Iterator
from functools import cache

import numpy as np
from registry import Row, measurement

from gaitlab.benchmarks.ocp_collection import BENCHMARKS, benchmark
from gaitlab.pipelines.inverse_methods import METHODS
from gaitlab.pipelines.ocp_benchmark import Forward, pose_inverse, solve_forward

FAST = next(iter(METHODS))
NOISE = 3.0
"""Standard deviations."""


@cache
def _forward(name: str) -> Forward:
    return solve_forward(benchmark(name))


@measurement(issue=3, line=1)
def optima() -> Iterator[Row]:
    for name in BENCHMARKS:
        forward = _forward(name)
        result, published = forward.result, forward.benchmark.published
        yield _row("not certified", float(not (result.converged and result.minimum)), "<= 0", "", name)
        yield _row("finer collocation, relative difference of the objective", forward.difference, "<= 1e-5", "", name)
        duration = abs(forward.finer.trajectory.duration / result.trajectory.duration - 1.0)
        yield _row("finer collocation, relative difference of the duration", duration, "<= 1e-5", "", name)
        yield _row("objective", result.solution.f, "", "", name)
        yield _row("duration", result.trajectory.duration, "", "s", name)
        yield _row("published duration minus ours", published.duration - result.trajectory.duration, "", "s", name)
        if published.objective is not None:
            yield _row("published objective minus ours", published.objective - result.solution.f, "", "", name)


@measurement(issue=3, line=2)
def every_method_on_every_benchmark() -> Iterator[Row]:
    for name in BENCHMARKS:
        forward = _forward(name)
        problem, w0, p0 = pose_inverse(
            forward, forward.benchmark.simulate(forward.transcribed, forward.result.solution.w)
        )
        results = {key: method.solve(problem, w0, p0) for key, method in METHODS.items()}
        best = min(result.objective for result in results.values() if result.converged)
        for key, result in results.items():
            gap = result.objective - best if result.converged else float("nan")
            yield _row(f"{key}: objective above the best (nan: {result.status})", gap, "", "", name)
            yield _row(f"{key}: lower-level residual", result.residuals.max(), "", "", name)
        dishonest = [result for result in results.values() if not result.reason]
        yield _row("results without a reason", float(len(dishonest)), "<= 0", "", name)


@measurement(issue=3, line=3)
def fast_path() -> Iterator[Row]:
    for name in BENCHMARKS:
        forward = _forward(name)
        problem, w0, p0 = pose_inverse(
            forward, forward.benchmark.simulate(forward.transcribed, forward.result.solution.w)
        )
        METHODS[FAST].solve(problem, w0, p0)
        # Processor time does not count what else the machine does; one thread.
        began = time.process_time()
        result = METHODS[FAST].solve(problem, w0, p0)
        seconds = time.process_time() - began
        yield _row("warm inverse problem by the fast path", seconds, "<= 0.5", "s", name)
        thesis = forward.benchmark.published_estimate.seconds
        if thesis is not None:
            yield _row("share of the thesis's time", seconds / thesis, "", "", name)
        worst = np.max(np.abs(result.p - forward.benchmark.truth) / (1e-12 + np.sqrt(np.diag(result.covariance))))
        yield _row("estimate minus truth in standard deviations", float(worst), "", "", name)


@measurement(issue=3, line=4)
def lifted_polar_robot() -> Iterator[Row]:
    name = "polar-robot-lifted"
    forward = _forward(name)
    problem, w0, p0 = pose_inverse(forward, forward.benchmark.simulate(forward.transcribed, forward.result.solution.w))
    fast = METHODS[FAST].solve(problem, w0, p0)
    deviation = np.sqrt(np.diag(fast.covariance))[problem.free]
    for solver in ("ipopt", "filtersqp"):
        result = METHODS[f"lifting-l1-{solver}"].solve(problem, w0, p0)
        off = float(np.max(np.abs(result.p - forward.benchmark.truth)[problem.free] / deviation))
        yield _row(
            f"l1-lifted, {solver}: worst estimate minus truth in standard deviations", off, f"<= {NOISE}", "", name
        )
        yield _row(f"l1-lifted, {solver}: not converged", float(not result.converged), "<= 0", "", name)
        yield _row(f"l1-lifted, {solver}: iterations (thesis 229)", float(result.iterations), "", "", name)


def _row(quantity: str, value: float, limit: str, unit: str, subject: str) -> Row:
    return Row(quantity=quantity, value=value, limit=limit, unit=unit, subject=subject)
