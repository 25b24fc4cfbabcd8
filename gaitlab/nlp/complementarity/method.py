"""What every treatment of complementarity offers, and the path of subproblems that most of them follow."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..diagnosis import FAR
from ..mpcc import MPCC
from ..mpcc_solution import MPCCSolution
from ..outcome import Outcome
from ..solution import NLPSolution
from ..solver import PreparedSolver

FATAL = (Outcome.INVALID_NUMBER, Outcome.CRASHED, Outcome.TIME_LIMIT)
"""Ends of a subproblem after which the next one would only repeat them."""
NO_PARAMETERS = np.zeros(0)


class PreparedMethod(Protocol):
    """A treatment bound to one problem."""

    def solve(self, w0: np.ndarray, p: np.ndarray = NO_PARAMETERS) -> MPCCSolution:
        """Solve from w0, shape (n_w,), for parameters p, shape (n_p,). Not converging is a result."""
        ...


class MPCCMethod(Protocol):
    """Settings of a treatment."""

    def prepare(self, problem: MPCC) -> PreparedMethod:
        """Bind to a problem: derivatives are formed once, many starts follow."""
        ...


@dataclass(frozen=True, kw_only=True)
class Schedule:
    """Values of the parameter that drives the subproblems to the problem: first * factor^k until past last."""

    first: float
    factor: float
    last: float

    def values(self) -> Iterator[float]:
        """The values in order, `last` included."""
        value, rising = self.first, self.factor > 1.0
        while value < self.last if rising else value > self.last:
            yield value
            value *= self.factor
        yield self.last


@dataclass(frozen=True, kw_only=True)
class PathEnd:
    """Where a sequence of subproblems ended."""

    w: np.ndarray
    """Variables of the subproblems, shape (n,)."""
    outcome: Outcome
    status: str
    iterations: int


def follow(
    solver: PreparedSolver,
    schedule: Schedule,
    w0: np.ndarray,
    p: np.ndarray,
    done: Callable[[np.ndarray], bool],
) -> PathEnd:
    """Solve the subproblems with parameters (p, value), each from the end of the last one, until one is `done`.

    w0 has shape (n,), p shape (n_p,). A subproblem that fails is skipped: the next one starts where it started. The
    path gives up when three in a row fail.
    """
    w, iterations, failures = w0, 0, 0
    last: NLPSolution | None = None
    for value in schedule.values():
        last = solver.solve(w, np.append(p, value))
        iterations += last.iterations
        if _usable(last):
            w, failures = last.w, 0
            if last.outcome is Outcome.SOLVED and done(w):
                break
        else:
            failures += 1
        if last.outcome in FATAL or failures == 3:
            break
    if last is None:
        return PathEnd(w=w, outcome=Outcome.STALLED, status="no subproblem was posed", iterations=0)
    # The best usable point is kept; what the solver said last tells why there is no better one.
    return PathEnd(w=w, outcome=last.outcome, status=last.status, iterations=iterations)


def _usable(solution: NLPSolution) -> bool:
    """Whether the next subproblem may start here: near the feasible set and not on the way to infinity."""
    near = solution.outcome is Outcome.SOLVED or solution.residuals.primal < 1e-6
    # Where the parameter is not far enough a subproblem may be unbounded although the problem is not.
    return near and solution.outcome is not Outcome.UNBOUNDED and bool(np.max(np.abs(solution.w), initial=0.0) < FAR)
