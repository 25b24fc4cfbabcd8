"""What was asked of a prediction, checked, and the way there from the identified gait."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np

from ..errors import InvalidSubject, NotFound, ProblemError
from ..multibody.body_change import heavier, stretched, twisted
from ..multibody.subject import SubjectModel
from .quantities import DEGREE, QUANTITIES, Present, Quantity, torque_limit
from .situation import Situation, Task

SHORTEST, LONGEST = 0.5, 2.0
"""Factors on a length or a mass that are still the same kind of body."""
ROUNDING = 1e-9
"""By which weights may miss their sum."""
INSIDE = 0.05
"""Limits begin this share of the peak, or this many radians, outside the identified gait."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """Quantities with the values that they are to have, in their own units."""

    present: Present
    values: Mapping[str, float]

    def __post_init__(self) -> None:
        for name, value in self.values.items():
            _check(QUANTITIES[name], value, self.present)
        tasks = [name for name in self.values if QUANTITIES[name].kind == "task"]
        if len(tasks) > 2:
            raise ProblemError("speed, step_length and cadence determine each other: set two of them at most")
        for name, value in self.values.items():
            if QUANTITIES[name].kind == "lowest angle":
                top = self.values.get(name.removesuffix("min") + "max", float("inf"))
                if value >= top:
                    raise InvalidSubject(f"{name} is {value:g} deg, not below the highest angle of {top:g} deg")
        given = self._given_weights()
        together, all_given = sum(given.values()), len(given) == len(self.present.gait.weights)
        if together > 1.0 + ROUNDING or (all_given and together < 1.0 - ROUNDING):
            raise InvalidSubject(f"the weights of all criteria add up to one; those that are given to {together:g}")

    def situation(self, share: float) -> Situation:
        """Body and task at a share of the way: 0 the identified, 1 what was asked for."""
        limits = self._limits(share)
        return Situation(
            subject=self._subject(share),
            task=self._task(share),
            springs=self._springs(share),
            lower=limits["lower"],
            upper=limits["upper"],
            torques={torque_limit(q): self._bound(q, share) for q in self._of_kind("torque")},
            weights=self._weights(share),
        )

    def _given_weights(self) -> dict[int, float]:
        return {self.present.criterion(q): self.values[q.name] for q in self._of_kind("weight")}

    def _weights(self, share: float) -> np.ndarray | None:
        """Weights of the criteria, shape (n_criteria,): those not given share the rest as they did; None: unchanged."""
        given = self._given_weights()
        if not given:
            return None
        old = self.present.gait.weights
        others = np.array([i not in given for i in range(len(old))])
        proportions = np.where(others, old if old[others].sum() > 0.0 else 1.0, 0.0)
        target = (1.0 - sum(given.values())) * proportions / max(float(proportions.sum()), ROUNDING)
        target[list(given)] = list(given.values())
        return old + share * (target - old)

    def _of_kind(self, *kinds: str) -> list[Quantity]:
        return [QUANTITIES[name] for name in self.values if QUANTITIES[name].kind in kinds]

    def _between(self, name: str, share: float) -> float:
        old = self.present.value(QUANTITIES[name])
        return old + share * (self.values[name] - old)

    def _subject(self, share: float) -> SubjectModel:
        subject = self.present.subject
        for q in self._of_kind("mass", "segment mass", "length", "torsion"):
            new = self._between(q.name, share)
            if q.kind == "torsion":
                subject = twisted(subject, q.segment, q.sign * new * DEGREE)
                continue
            factor = new / self.present.value(q)
            if q.kind == "length":
                subject = stretched(subject, q.segment, factor)
            for segment in [q.segment] if q.kind == "segment mass" else self._all_segments(q):
                subject = heavier(subject, segment, factor)
        return subject

    def _all_segments(self, quantity: Quantity) -> list[str]:
        return [s.name for s in self.present.subject.segments] if quantity.kind == "mass" else []

    def _task(self, share: float) -> Task:
        def value(name: str) -> float | None:
            return self._between(name, share) if name in self.values else None

        step, cadence, speed = value("step_length"), value("cadence"), value("speed")
        length = None if step is None else 2.0 * step
        time = None if cadence is None else 120.0 / cadence
        if speed is None and (length is None or time is None):
            speed = self.present.speed
        return Task(speed=speed, stride_length=length, stride_time=time)

    def _springs(self, share: float) -> dict[int, tuple[float, float]]:
        springs: dict[int, tuple[float, float]] = {}
        for q in self._of_kind("orthosis"):
            if q.name.endswith("_neutral"):
                continue
            neutral = self.values.get(f"{q.name}_neutral", 0.0) * DEGREE
            springs[q.coordinate] = (share * self.values[q.name] / DEGREE, q.sign * neutral)
        return springs

    def _limits(self, share: float) -> dict[str, dict[int, float]]:
        limits: dict[str, dict[int, float]] = {"lower": {}, "upper": {}}
        for q in self._of_kind("lowest angle", "highest angle"):
            outward = -1.0 if q.kind == "lowest angle" else 1.0
            edge = self.present.value(q) * DEGREE + outward * INSIDE
            target = self.values[q.name] * DEGREE
            start = target if outward * (target - edge) >= 0.0 else edge
            bound = q.sign * (start + share * (target - start))
            limits["upper" if outward * q.sign > 0.0 else "lower"][q.coordinate] = bound
        return limits

    def _bound(self, quantity: Quantity, share: float) -> float:
        peak, target = max(self.present.value(quantity), 0.0), self.values[quantity.name]
        start = max(target, (1.0 + INSIDE) * peak + 1.0)
        return start + share * (target - start)


def parse_request(assignments: Sequence[str], present: Present) -> Request:
    """A request from texts `name=value` or `name=+10%`.

    Raises:
        NotFound: a quantity does not exist.
        ProblemError: a text is no assignment, or a quantity is set twice.
        InvalidSubject: a value is impossible.
    """
    values: dict[str, float] = {}
    for text in assignments:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name:
            raise ProblemError(f"'{text}' is not name=value, for instance speed=+20% or left_tibial_torsion=-15")
        if name not in QUANTITIES:
            raise NotFound("quantity", name, QUANTITIES)
        if name in values:
            raise ProblemError(f"{name} is set twice")
        values[name] = _value(QUANTITIES[name], value, present)
    return Request(present=present, values=values)


def _value(quantity: Quantity, text: str, present: Present) -> float:
    percent = text.endswith("%")
    try:
        number = float(text.removesuffix("%"))
    except ValueError as error:
        raise ProblemError(f"{quantity.name}={text} is no number in {quantity.unit}, nor a change like +10%") from error
    if not percent:
        return number
    if not quantity.relative_to:
        raise ProblemError(f"{quantity.name} takes a number in {quantity.unit}, not a percentage")
    if text[0] not in "+-":
        raise ProblemError(f"{quantity.name}={text}: write the change with its sign, for instance +10% or -10%")
    return present.value(quantity) * (1.0 + number / 100.0)


def _check(quantity: Quantity, value: float, present: Present) -> None:
    low, high = quantity.lowest, quantity.highest
    if quantity.kind in ("length", "mass", "segment mass"):
        old = present.value(quantity)
        low, high = max(low, SHORTEST * old), min(high, LONGEST * old)
    if not isfinite(value) or not low <= value <= high:
        unit = f" {quantity.unit}" if quantity.unit else ""
        raise InvalidSubject(f"{quantity.name} is {value:g}{unit}: give a value from {low:.4g} to {high:.4g}{unit}")
