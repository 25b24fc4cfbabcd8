"""What if the walk traded off differently? The optimal walk followed while the weights of its criteria move.

The weights go along a straight line in the simplex, theta(s) = (1 - s) theta_0 + s theta_1. Along it the optimal walk
is followed as a path: the optimality conditions of the lower level predict it to first order (implicit function
theorem, `nlp.sensitivity`), the interior-point method corrects the prediction, started with its multipliers. The step
length follows the corrector's iterations and the prediction's error: a solution that lies farther from the prediction
than the prediction from the last solution may be another local optimum. Where no step is short enough the walk has no
continuation for these weights (a fold of the optimality conditions), and the sweep ends there and says so.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Generic, Protocol, TypeVar

import numpy as np

from ..errors import NotConverged, ProblemError
from ..nlp.sensitivity import Sensitivity
from ..nlp.sparse_solution import SparseSolution, Status
from .identification import WalkOptimum

Progress = Callable[[float], None]
"""Called with the share of the way that is done; cancels by raising `errors.Cancelled`."""


class SweepResponse(Protocol):
    """A solution of the lower level that knows how it moves with the weights."""

    @property
    def solution(self) -> SparseSolution:
        """Certified solution."""
        ...

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """Factorised optimality conditions."""
        ...

    def predict(self, step: np.ndarray) -> SparseSolution:
        """First-order prediction of the solution after a step in the weights, shape (n_theta,)."""
        ...


R = TypeVar("R", bound=SweepResponse)
R_co = TypeVar("R_co", bound=SweepResponse, covariant=True)


class SweepLevel(Protocol[R_co]):
    """A lower level, for instance `identification.WalkLevel`."""

    @property
    def n_theta(self) -> int:
        """Number of weights."""
        ...

    def respond(self, theta: np.ndarray, start: SparseSolution) -> R_co:
        """Solve for theta, shape (n_theta,), from a nearby solution."""
        ...


class SweepStatus(StrEnum):
    """How a sweep ended."""

    COMPLETE = "the other weights were reached"
    UNSOLVED = "the lower level is not solved beyond this point"
    JUMP = "the optimum that was followed ends here: beyond, only another one is found"
    NO_MINIMUM = "the solution stops being a minimum here"


@dataclass(frozen=True, kw_only=True)
class SweepStep(Generic[R]):
    """The optimal walk for one set of weights on the way."""

    share: float
    """Share s of the way."""
    theta: np.ndarray
    """Weights, shape (n_theta,)."""
    response: R = field(repr=False)
    prediction_error: float
    """Distance to the prediction, as a multiple of the predicted move; nought at the start."""


@dataclass(frozen=True, kw_only=True)
class Sweep(Generic[R]):
    """All steps in order, the start among them."""

    steps: tuple[SweepStep[R], ...]
    status: SweepStatus
    reason: str
    rejected: int
    """Steps that were tried and repeated with half the length."""

    @property
    def is_complete(self) -> bool:
        """Whether the other weights were reached."""
        return self.status is SweepStatus.COMPLETE


@dataclass(frozen=True, kw_only=True)
class WhatIf:
    """Settings of the method."""

    first_step: float = 0.1
    """First step as a share of the way."""
    max_step: float = 0.25
    min_step: float = 1e-4
    growth: float = 1.5
    few_iterations: int = 6
    """Corrector iterations up to which the next step may be longer."""
    max_prediction_error: float = 1.0
    """Solutions farther from the prediction than this multiple of the predicted move are not accepted."""

    def sweep(
        self,
        level: SweepLevel[R],
        start: tuple[np.ndarray, R],
        theta: np.ndarray,
        shares: tuple[float, ...] = (),
        progress: Progress | None = None,
    ) -> Sweep[R]:
        """Follow the optimum from weights whose response is known to the weights theta, shape (n_theta,).

        `shares` of the way are met exactly (others are chosen by the step control). Raises `ProblemError` where
        weights are not on the simplex or shares not between 0 and 1.
        """
        for weights in (start[0], theta):
            if weights.shape != (level.n_theta,) or np.any(weights < 0.0) or abs(weights.sum() - 1.0) > 1e-9:
                raise ProblemError(f"weights must be {level.n_theta} numbers >= 0 with sum 1, got {weights}")
        if any(not 0.0 <= share <= 1.0 for share in shares):
            raise ProblemError(f"shares must lie between 0 and 1, got {shares}")
        stops = np.unique([*shares, 1.0])
        return _Run(self, level, start, theta, stops[stops > 0.0]).run(progress)


class _Run(Generic[R]):
    """One sweep and what it has so far."""

    def __init__(
        self, method: WhatIf, level: SweepLevel[R], start: tuple[np.ndarray, R], theta: np.ndarray, stops: np.ndarray
    ) -> None:
        self.method, self.level, self.way, self.stops = method, level, theta - start[0], stops
        self.steps = [SweepStep(share=0.0, theta=start[0], response=start[1], prediction_error=0.0)]
        self.rejected = 0
        self.failure = SweepStatus.UNSOLVED
        self.told = ""

    def run(self, progress: Progress | None) -> Sweep[R]:
        begin = self.steps[0].response
        if begin.solution.status is not Status.SOLVED:
            return self._end(SweepStatus.UNSOLVED, f"the start is no solution: {begin.solution.status.value}")
        if not np.any(self.way):
            return self._end(SweepStatus.COMPLETE, "both sets of weights are the same")
        h = self.method.first_step
        while self.steps[-1].share < 1.0:
            if progress is not None:
                progress(self.steps[-1].share)
            found = self._step(h)
            if found is None:
                last = self.steps[-1].share
                return self._end(self.failure, f"{self.failure.value}, after {last:.4f} of the way: {self.told}")
            self.steps.append(found[0])
            quick = found[0].response.solution.iterations <= self.method.few_iterations
            h = min(self.method.max_step, found[1] * (self.method.growth if quick else 1.0))
        return self._end(SweepStatus.COMPLETE, SweepStatus.COMPLETE.value)

    def _step(self, h: float) -> tuple[SweepStep[R], float] | None:
        """The next step and the length that worked; None where none is short enough."""
        last = self.steps[-1]
        stop = float(self.stops[self.stops > last.share][0])
        while h >= self.method.min_step:
            share = stop if last.share + h >= stop - 1e-12 else last.share + h
            step = self._try(share)
            if step is not None:
                return step, h
            self.rejected += 1
            h = 0.5 * min(h, share - last.share)
        return None

    def _try(self, share: float) -> SweepStep[R] | None:
        last = self.steps[-1]
        move = (share - last.share) * self.way
        theta = self.steps[0].theta + share * self.way
        try:
            predicted = last.response.predict(move)
        except NotConverged as error:
            return self._reject(SweepStatus.NO_MINIMUM, str(error))
        response = self.level.respond(theta, predicted)
        solution = response.solution
        if solution.status is not Status.SOLVED:
            return self._reject(SweepStatus.UNSOLVED, solution.status.value)
        if not response.sensitivity.is_minimum():
            return self._reject(SweepStatus.NO_MINIMUM, "the reduced Hessian has a negative eigenvalue")
        error = relative_distance(
            solution.w, predicted.w, relative_distance(predicted.w, last.response.solution.w, 1.0)
        )
        if error > self.method.max_prediction_error:
            return self._reject(SweepStatus.JUMP, f"the next solution is {error:.1f} predicted moves away")
        return SweepStep(share=share, theta=theta, response=response, prediction_error=error)

    def _reject(self, status: SweepStatus, told: str) -> None:
        self.failure, self.told = status, told

    def _end(self, status: SweepStatus, reason: str) -> Sweep[R]:
        return Sweep(steps=tuple(self.steps), status=status, reason=reason, rejected=self.rejected)


def relative_distance(a: np.ndarray, b: np.ndarray, unit: float) -> float:
    """Norm of a - b, shapes (n,), in a unit; differences within rounding of the solver count as none."""
    d = float(np.linalg.norm(a - b))
    return 0.0 if d <= 1e-6 * (1.0 + float(np.linalg.norm(b))) else d / max(unit, 1e-300)


def with_weight(theta: np.ndarray, index: int, value: float) -> np.ndarray:
    """Weights theta, shape (n_theta,), with one of them at a value in [0, 1] and the others in their old proportion.

    Where the others are all zero they share the rest equally. Raises `ProblemError` for a value outside.
    """
    if not 0.0 <= value <= 1.0:
        raise ProblemError(f"a weight must lie between 0 and 1, got {value}")
    others = np.arange(len(theta)) != index
    rest = (
        theta[others] / theta[others].sum() if theta[others].sum() > 0.0 else np.full(others.sum(), 1.0 / others.sum())
    )
    result = np.empty(len(theta))
    result[index], result[others] = value, (1.0 - value) * rest
    return result


def gait_curves(sweep: Sweep[WalkOptimum]) -> np.ndarray:
    """Coordinates [m, rad] of every step's optimal walk at the nodes, shape (n_steps, N + 1, n_q)."""
    states = [s.response.problem.states(s.response.solution.w) for s in sweep.steps]
    return np.stack(states)[:, :, : states[0].shape[1] // 2]
