"""A new gait for a changed body or task: continuation from the identified gait in small, certified steps."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ..errors import NotConverged
from .identified_gait import IdentifiedGait
from .prediction_problem import HabitSettings, PredictionProblem
from .prediction_step import Corrector, Outer, PredictedPoint, TimeHabit
from .situation import Situation

CERTIFICATE = 1e-6
"""Largest first-order residual of an accepted solution."""

Change = Callable[[float], Situation]
"""The situation at a share of the way, from 0 (the identified gait's) to 1 (what was asked for)."""
Progress = Callable[[float, int], None]
"""Called with the share that is done and the number of steps; cancels by raising `errors.Cancelled`."""


@dataclass(frozen=True, kw_only=True)
class PredictionSettings:
    """Settings of the method."""

    habit: HabitSettings = field(default_factory=HabitSettings)
    """Where `firmer` starts from."""
    margin: float = 2.0
    """Multiple of the weakest habit for which the identified gait is a strict minimum."""
    firmest: float = 1e4
    """Habit [1/rad^2] beyond which the search for it is given up."""
    first_step: float = 0.2
    max_step: float = 0.5
    min_step: float = 1e-3
    jump_step: float = 0.02
    """Steps shorter than this may go to another optimum, where the one that is followed ends."""
    max_prediction_error: float = 1.0
    """Solutions farther from the prediction than this multiple of the predicted move are another optimum."""
    growth: float = 1.6
    few_iterations: int = 15
    corrector: Corrector = field(default_factory=Corrector)


@dataclass(frozen=True, kw_only=True)
class PredictionStep:
    """One certified solution on the way."""

    share: float
    point: PredictedPoint = field(repr=False)
    jump: bool = False
    """Whether the optimum that was followed ended before this step, and another one was found near it."""

    @property
    def time(self) -> float:
        """Stride time [s]."""
        return self.point.family.duration * float(np.exp(self.point.outer.log_time))

    @property
    def length(self) -> float:
        """Stride length [m]."""
        return self.point.situation.task.length(self.time)

    @property
    def residual(self) -> float:
        """Largest violation of the first-order conditions, periodicity and stride time among them."""
        return max(self.point.solution.residuals.max(), float(np.max(np.abs(self.point.residual))))

    @property
    def is_certified(self) -> bool:
        """First-order conditions to 1e-6 and a minimum to second order."""
        return self.residual < CERTIFICATE and self.point.is_minimum()


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """All steps in order, the identified gait first."""

    steps: tuple[PredictionStep, ...]
    habit: HabitSettings
    """The habit as used."""
    rejected: int
    """Steps that were tried and repeated with half the length."""
    reason: str = ""
    """Why the path ends before what was asked for; empty where it does not."""

    @property
    def is_complete(self) -> bool:
        """Whether the body and the task that were asked for were reached."""
        return self.steps[-1].share >= 1.0


def predict(
    gait: IdentifiedGait, change: Change, settings: PredictionSettings | None = None, progress: Progress | None = None
) -> Prediction:
    """Follow the identified gait while body and task change.

    Raises:
        NotConverged: the identified gait is no strict minimum, however firm the habit.
        ProblemError: it lies outside the limits of `change(0)`.
    """
    return _Run(gait, change, settings or PredictionSettings()).run(progress)


class _Run:
    """One prediction and what it has so far."""

    def __init__(self, gait: IdentifiedGait, change: Change, settings: PredictionSettings) -> None:
        self.change, self.settings = change, settings
        point, self.habit = _start(gait, change(0.0), settings)
        self.steps = [PredictionStep(share=0.0, point=point)]
        self.rejected, self.told = 0, ""

    def run(self, progress: Progress | None) -> Prediction:
        """Steps of adapted length until the end or until none is short enough."""
        h, settings = self.settings.first_step, self.settings
        while self.steps[-1].share < 1.0 and h >= settings.min_step:
            if progress is not None:
                progress(self.steps[-1].share, len(self.steps))
            last = self.steps[-1].share
            found = self._try(1.0 if last + 1.1 * h >= 1.0 else last + h, jump_allowed=h < settings.jump_step)
            if found is None:
                self.rejected, h = self.rejected + 1, 0.5 * h
                continue
            self.steps.append(found)
            quick = found.point.solution.iterations <= settings.few_iterations
            h = min(settings.max_step, h * (settings.growth if quick else 1.0))
        share = self.steps[-1].share
        reason = "" if share >= 1.0 else f"no gait was found beyond {100 * share:.1f} % of the change: {self.told}"
        return Prediction(steps=tuple(self.steps), habit=self.habit, rejected=self.rejected, reason=reason)

    def _try(self, share: float, jump_allowed: bool) -> PredictionStep | None:
        try:
            point, error = self.settings.corrector.solve(self.steps[-1].point, self.change(share))
            found = PredictionStep(share=share, point=point, jump=error > self.settings.max_prediction_error)
            if found.jump and not jump_allowed:
                self.told = "the optimum that was followed ends here"
            elif not found.is_certified:
                self.told = "the solution found is no minimum"
            else:
                return found
        except (NotConverged, np.linalg.LinAlgError) as failure:
            self.told = str(failure)
        return None


def _start(
    gait: IdentifiedGait, situation: Situation, settings: PredictionSettings
) -> tuple[PredictedPoint, HabitSettings]:
    """The identified gait as first point, with the weakest habit, times the margin, that makes it a minimum."""
    habit = settings.habit
    while habit.angle <= settings.firmest:
        if _first_point(PredictionProblem(gait, situation, habit)).is_minimum():
            habit = habit.firmer(settings.margin)
            return _first_point(PredictionProblem(gait, situation, habit)), habit
        habit = habit.firmer(2.0)
    raise NotConverged(
        f"the identified gait is no strict minimum even with a habit of {habit.angle:g}/rad^2; "
        "analyse another stride, or the same one with other criteria"
    )


def _first_point(family: PredictionProblem) -> PredictedPoint:
    """The identified gait, its stride time held by its price and by a spring as stiff as the rest.

    The stiffness is the curvature of the cost against a change of stride time at given speed: the person changes time
    and length of the stride with equal reluctance.
    """
    outer, situation = Outer(np.zeros(len(family.rows)), 0.0), family.first_situation
    bare = PredictedPoint(family, situation, outer, family.start, TimeHabit(0.0, 0.0))
    if not situation.task.frees_time:
        return bare
    curvature = 1.0 / float(np.linalg.inv(bare.jacobian)[-1, -1])
    return PredictedPoint(family, situation, outer, family.start, TimeHabit(-bare.time_slope, max(curvature, 0.0)))
