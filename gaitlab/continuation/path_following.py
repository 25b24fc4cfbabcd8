"""Pseudo-arclength continuation: solutions of n - 1 equations in n unknowns as a path that may turn back.

Predictor along the tangent, Newton corrector in the plane normal to it, step length by the number of Newton steps and
the angle between tangents (Keller 1977; Allgower and Georg, Introduction to Numerical Continuation Methods, SIAM 2003,
ch. 6 and 10). Events are bracketed by their sign and located with Brent's method, every trial point corrected.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from scipy.optimize import brentq

from ..errors import ProblemError
from .bordered import bordered, least_norm_step, null_pair, solve
from .extended_system import PathSystem
from .path_events import Event, PathPoint, tangent_matrix

NO_SIGN = 1e-8
"""Tests smaller than this at the first point of a path belong to the event the path starts at."""


class PathStatus(StrEnum):
    """How a path ended."""

    EVENT = "stopped at an event"
    BOUND = "a parameter reached its bound"
    POINTS = "number of points reached"
    STEP = "no step is short enough for the corrector"
    START = "the start cannot be corrected to a solution"
    INVALID = "a function returned a number that is not finite"


@dataclass(frozen=True, kw_only=True)
class LocatedPoint:
    """An event, with its certificate."""

    event: str
    x: np.ndarray = field(repr=False)
    """Unknowns, shape (n,)."""
    tangent: np.ndarray = field(repr=False)
    """Tangent of the path there, shape (n,)."""
    system: PathSystem = field(repr=False)
    """The system that the point solves."""
    residual: float
    """Largest equation of the whole system, evaluated anew."""
    test: float
    """Remaining value of the test function."""

    def is_certified(self, tol: float) -> bool:
        """Whether equations and event hold to the absolute tolerance `tol`."""
        return self.residual <= tol and abs(self.test) <= tol


@dataclass(frozen=True, kw_only=True)
class Path:
    """Points along a path in order, and what was found on it."""

    x: np.ndarray = field(repr=False)
    """Unknowns, shape (n_points, n)."""
    parameters: dict[str, np.ndarray] = field(repr=False)
    """Values of all continuation parameters, each of shape (n_points,)."""
    events: tuple[LocatedPoint, ...]
    status: PathStatus
    reason: str
    system: PathSystem = field(repr=False)
    """The system at the end, its moving references at the last point."""

    def located(self, name: str) -> tuple[LocatedPoint, ...]:
        """Events of one name."""
        return tuple(e for e in self.events if e.event == name)


@dataclass(frozen=True, kw_only=True)
class PathFollowing:
    """Settings of the method; the step control follows Allgower and Georg, sec. 6.1."""

    tol: float = 1e-10
    """Largest equation of a corrected point."""
    max_newton: int = 8
    step: float = 0.1
    """First step length."""
    min_step: float = 1e-7
    max_step: float = 0.5
    max_points: int = 200
    min_cosine: float = 0.9
    """Steps whose tangents differ more are repeated with half the length: they may have jumped to another path."""
    event_tol: float = 1e-13
    """Arc length to which events are located."""

    def follow(
        self,
        system: PathSystem,
        x0: np.ndarray,
        *,
        direction: int | np.ndarray = 1,
        events: Sequence[Event] = (),
        bounds: dict[str, tuple[float, float]] | None = None,
    ) -> Path:
        """Follow the path through x0, shape (n,), which is corrected first.

        `direction` is 1, -1 (the sign of the tangent's largest component) or a vector, shape (n,), to go along. A path
        ends where a parameter leaves its bounds. What goes wrong is told by the path's status and reason.
        """
        for name in bounds or {}:
            system.parameter(x0, name)
        if x0.shape != system.weights.shape:
            raise ProblemError(f"the start must have shape {system.weights.shape}, got {x0.shape}")
        return _Run(self, system, tuple(events), bounds or {}).run(x0, direction)

    def correct(self, system: PathSystem, x0: np.ndarray) -> np.ndarray | None:
        """Solution nearest to x0, shape (n,), by least-norm Newton steps; None where they do not converge."""
        x = x0.copy()
        for _ in range(2 * self.max_newton):
            residual = system.residual(x)
            if not np.all(np.isfinite(residual)):
                return None
            if _norm(residual) <= self.tol:
                return x
            step = least_norm_step(system.jacobian(x), residual)
            if step is None:
                return None
            x = x + step
        return x if _norm(system.residual(x)) <= self.tol else None

    def advance(self, system: PathSystem, point: PathPoint, h: float) -> PathPoint | None:
        """The point at arc length h (measured along the tangent), or None where the corrector fails."""
        row = system.weights * point.tangent
        x = point.x + h * point.tangent
        for steps in range(self.max_newton + 1):
            residual = system.residual(x)
            if not np.all(np.isfinite(residual)):
                return None
            if _norm(residual) <= self.tol:
                tangent = tangent_at(system, x, point.tangent)
                return None if tangent is None else PathPoint(x=x, tangent=tangent, newton_steps=steps)
            offset = float(row @ (x - point.x)) - h
            step = solve(bordered(system.jacobian(x), row), -np.append(residual, offset))
            if step is None:
                return None
            x = x + step
        return None


def switched(method: PathFollowing, point: LocatedPoint, direction: np.ndarray, h: float) -> PathPoint | None:
    """First point on the branch that leaves a branch point along a direction, shape (n,), at the distance h.

    At the branch point itself the tangent is not unique, so that the new path starts beside it.
    """
    return method.advance(point.system, PathPoint(x=point.x, tangent=direction), h)


def tangent_at(system: PathSystem, x: np.ndarray, along: np.ndarray) -> np.ndarray | None:
    """Unit tangent at x, shape (n,), that points the same way as `along`; None where it is not unique."""
    right = np.zeros(len(x))
    right[-1] = 1.0
    t = solve(bordered(system.jacobian(x), system.weights * along), right)
    if t is None:
        return None
    t = t / np.max(np.abs(t))  # Almost singular matrices give numbers whose squares are infinite.
    return t / np.sqrt(np.sum(system.weights * t**2))


def branch_direction(system: PathSystem, point: LocatedPoint) -> np.ndarray | None:
    """Unit vector, shape (n,), in the null space of the Jacobian at a branch point and normal to the path there."""
    pair = null_pair(tangent_matrix(system, PathPoint(x=point.x, tangent=point.tangent)))
    if pair is None:
        return None
    return pair.right / np.sqrt(np.sum(system.weights * pair.right**2))


class _Run:
    """One path: the settings, the problem, and what has been found so far."""

    def __init__(
        self,
        method: PathFollowing,
        system: PathSystem,
        events: tuple[Event, ...],
        bounds: dict[str, tuple[float, float]],
    ) -> None:
        self.method, self.system, self.wanted, self.bounds = method, system, events, bounds
        self.points: list[np.ndarray] = []
        self.found: list[LocatedPoint] = []
        self.tests: list[float] = []

    def run(self, x0: np.ndarray, direction: int | np.ndarray) -> Path:
        self.points = [x0]
        part = self.system.invalid_part(x0)
        if part is not None:
            return self._path(PathStatus.INVALID, f"'{part}' returned a number that is not finite at the start")
        x = self.method.correct(self.system, x0)
        if x is None:
            worst = _norm(self.system.residual(x0))
            return self._path(
                PathStatus.START, f"the start does not satisfy the equations ({worst:.1e}) nor lead there"
            )
        self.points, self.system = [x], self.system.refreshed(x)
        tangent = self._first_tangent(x, direction)
        if tangent is None:
            return self._path(PathStatus.START, "the start lies on no single path: its Jacobian has no full rank")
        return self._march(PathPoint(x=x, tangent=tangent))

    def _first_tangent(self, x: np.ndarray, direction: int | np.ndarray) -> np.ndarray | None:
        if isinstance(direction, np.ndarray):
            return tangent_at(self.system, x, direction)
        generator = np.random.default_rng(0)
        t = tangent_at(self.system, x, generator.normal(size=len(x)))
        return None if t is None else direction * np.sign(t[np.argmax(np.abs(t))]) * t

    def _march(self, point: PathPoint) -> Path:
        h = self.method.step
        tests = [event.test(self.system, point) for event in self.wanted]
        # The path may start at an event of an earlier one: a sign within rounding is none.
        self.tests = [math.nan if abs(test) <= NO_SIGN else test for test in tests]
        for _ in range(self.method.max_points):
            step = self._step(point, h)
            if step is None:
                return self._path(PathStatus.STEP, self._why_stuck(point))
            new, h = step
            end = self._look_back(point, new, h)
            if end is not None:
                return end
            self.points.append(new.x)
            outside = self._outside(new)
            if outside is not None:
                return self._path(PathStatus.BOUND, f"'{outside}' reached its bound")
            self.system = self.system.refreshed(new.x)
            h = min(self.method.max_step, h * (1.5 if new.newton_steps <= 3 else 1.0 if new.newton_steps <= 5 else 0.5))
            point = new
        return self._path(PathStatus.POINTS, f"{self.method.max_points} points without an event that stops the path")

    def _step(self, point: PathPoint, h: float) -> tuple[PathPoint, float] | None:
        """The next point and the step length that led there."""
        while h >= self.method.min_step:
            new = self.method.advance(self.system, point, h)
            if new is not None and self._is_close(point, new):
                return new, h
            h /= 2.0
        return None

    def _is_close(self, a: PathPoint, b: PathPoint) -> bool:
        """Whether the step from a to b was short enough: tangents alike, and nothing that the system minds."""
        cosine = float(np.sum(self.system.weights * a.tangent * b.tangent))
        return cosine >= self.method.min_cosine and self.system.admits(a.x, b.x)

    def _look_back(self, a: PathPoint, b: PathPoint, h: float) -> Path | None:
        """Locate the events between two points; the finished path where one of them ends it."""
        before, self.tests = self.tests, [event.test(self.system, b) for event in self.wanted]
        crossed = [
            event
            for event, old, new in zip(self.wanted, before, self.tests, strict=True)
            if new == 0.0 or old * new < 0.0
        ]
        located = [(*self._locate(event, a, b, h), event) for event in crossed]
        for _, point, event in sorted(located, key=lambda entry: entry[0]):
            self.found.append(point)
            if event.stops:
                self.points.append(point.x)
                return self._path(PathStatus.EVENT, f"stopped at {event.name}")
        return None

    def _locate(self, event: Event, a: PathPoint, b: PathPoint, h: float) -> tuple[float, LocatedPoint]:
        measure = event.measure(self.system, b)
        values = measure(self.system, a), measure(self.system, b)
        best = [b]

        def along(s: float) -> float:
            # At the event itself the corrector may meet a singular matrix: a hair's breadth beside it will do.
            point = self.method.advance(self.system, a, s) or self.method.advance(self.system, a, s + 1e-9 * h)
            if point is None:
                return 0.0
            best[0] = point
            return measure(self.system, point)

        s = self._root(along, values, h)
        point = best[0]
        located = LocatedPoint(
            event=event.name,
            x=point.x,
            tangent=point.tangent,
            system=self.system,
            residual=_norm(self.system.residual(point.x)),
            test=measure(self.system, point),
        )
        return s, located

    def _root(self, along: Callable[[float], float], values: tuple[float, float], h: float) -> float:
        if values[1] == 0.0:
            return h

        def function(s: float) -> float:
            return values[0] if s == 0.0 else values[1] if s == h else along(s)

        root, _ = brentq(function, 0.0, h, xtol=self.method.event_tol, full_output=True)
        return float(root)

    def _outside(self, point: PathPoint) -> str | None:
        for name, (lower, upper) in self.bounds.items():
            if not lower <= self.system.parameter(point.x, name) <= upper:
                return name
        return None

    def _why_stuck(self, point: PathPoint) -> str:
        x = point.x + self.method.min_step * point.tangent
        part = self.system.invalid_part(x)
        if part is not None:
            return f"'{part}' returned a number that is not finite beyond this point"
        return f"the corrector fails for steps down to {self.method.min_step:g}; is the problem smooth here?"

    def _path(self, status: PathStatus, reason: str) -> Path:
        names = self.system.parameter_names()
        return Path(
            x=np.array(self.points),
            parameters={n: np.array([self.system.parameter(x, n) for x in self.points]) for n in names},
            events=tuple(self.found),
            status=status,
            reason=reason,
            system=self.system,
        )


def _norm(v: np.ndarray) -> float:
    return float(np.max(np.abs(v), initial=0.0))
