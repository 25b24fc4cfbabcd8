"""Issue 3, section 4: extrema by successive continuation beside published and exact values; derivatives and orders."""

import time
from collections.abc import Callable, Iterator

import numpy as np
from registry import Row, measurement

from gaitlab.benchmarks.auto_ops import FIRST_EXTREMUM, auto_ops
from gaitlab.benchmarks.auto_opt import MAXIMA, auto_opt
from gaitlab.benchmarks.bratu import bratu, exact_critical
from gaitlab.benchmarks.forced_oscillator import amplitude_difference, fastest_start, largest_difference
from gaitlab.benchmarks.limit_cycle import limit_cycle
from gaitlab.continuation.extremum import Extremum, ExtremumProblem, SuccessiveContinuation
from gaitlab.continuation.path_following import PathFollowing

METHOD = SuccessiveContinuation(path=PathFollowing(step=0.05))
EXACT: dict[str, tuple[Callable[[], ExtremumProblem], float]] = {
    "Bratu": (bratu, exact_critical()),
    "forced oscillator": (fastest_start, 1.0),
    "two glued oscillators": (amplitude_difference, largest_difference()[1]),
    "limit cycle": (limit_cycle, 0.5),
    "limit cycle, p1 <= 0.8": (lambda: limit_cycle(bound=0.8), 0.48),
}
STEP = 1e-6


@measurement(issue=3, line=6)
def auto_demos() -> Iterator[Row]:
    found, seconds = _timed(auto_opt())
    error = max(abs(stage.objective - value) for stage, value in zip(found.stages[1:], MAXIMA, strict=True))
    yield _row("worst deviation of four maxima", error, "<= 1e-8", "AUTO opt")
    yield from _certificate(found, seconds, "AUTO opt")
    coarse, seconds = _timed(auto_ops(20))
    yield _row(
        "first extremum beside 0.921972", abs(coarse.stages[0].objective - FIRST_EXTREMUM), "<= 1e-6", "AUTO ops"
    )
    yield from _certificate(coarse, seconds, "AUTO ops, 20 intervals")
    fine, seconds = _timed(auto_ops(40))
    yield from _certificate(fine, seconds, "AUTO ops, 40 intervals")
    for a, b in zip(coarse.stages, fine.stages, strict=True):
        yield _row(f"20 beside 40 intervals, {a.name}", abs(a.objective - b.objective), "<= 1e-6", "AUTO ops")
        yield _row(f"p3 at {b.name}", b.objective, "", "AUTO ops")


@measurement(issue=3, line=6)
def known_extrema() -> Iterator[Row]:
    for name, (make, value) in EXACT.items():
        found, seconds = _timed(make())
        yield _row("deviation from the exact extremum", abs(found.objective - value), "<= 1e-7", name)
        yield from _certificate(found, seconds, name)


@measurement(issue=3, line=6)
def derivatives_of_the_optimality_system() -> Iterator[Row]:
    for name, (make, _) in EXACT.items():
        found = METHOD.solve(make())
        system = found.system
        x = found.x + 0.01 * np.random.default_rng(0).normal(size=len(found.x))
        columns = [(system.residual(x + e) - system.residual(x - e)) / (2 * STEP) for e in STEP * np.eye(len(x))]
        jacobian = system.jacobian(x).toarray()
        error = np.abs(jacobian - np.array(columns).T).max() / np.abs(jacobian).max()
        yield _row("Jacobian beside central differences, relative", error, "<= 1e-6", name)


@measurement(issue=3, line=6)
def order_of_optima() -> Iterator[Row]:
    errors = [abs(METHOD.solve(fastest_start(n)).objective - 1.0) for n in (4, 8)]
    yield _row("order of the optimum, degree 4 (8 expected)", np.log2(errors[0] / errors[1]), ">= 7.5", "oscillator")


def _timed(problem: ExtremumProblem) -> tuple[Extremum, float]:
    """Processor time: it does not count what else the machine does."""
    begin = time.process_time()
    return METHOD.solve(problem), time.process_time() - begin


def _certificate(found: Extremum, seconds: float, subject: str) -> Iterator[Row]:
    yield _row("not converged", float(not found.converged), "<= 0", subject)
    yield _row("residual of the optimality system", found.residual, "<= 1e-8", subject)
    yield Row(quantity="processor time", value=seconds, limit="", unit="s", subject=subject)


def _row(quantity: str, value: float, limit: str, subject: str) -> Row:
    return Row(quantity=quantity, value=float(value), limit=limit, unit="", subject=subject)
