"""Runge-Kutta methods as expressions: explicit, and implicit with Newton's method written out."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import casadi as ca
import numpy as np

from ..errors import ProblemError
from .polynomials import lagrange_integrals, radau_points

RightHandSide = Callable[[ca.SX, ca.SX], ca.SX]
"""(s, x) -> dx/ds."""


class Sample(NamedTuple):
    """A stage of a Runge-Kutta step, with its share of the quadrature."""

    s: ca.SX
    x: ca.SX
    """State, shape (n_x, 1)."""
    weight: ca.SX
    """Weight of an integrand there."""


class Step(NamedTuple):
    """Result of one step or of several."""

    x: ca.SX
    """State at the end, shape (n_x, 1)."""
    samples: list[Sample]


class Integrator(Protocol):
    """A one-step method applied some number of times."""

    def integrate(self, f: RightHandSide, s: ca.SX, x: ca.SX, width: ca.SX) -> Step:
        """From state x at s to s + width."""
        ...


@dataclass(frozen=True, kw_only=True)
class RungeKutta4:
    """Classical explicit method of order 4 (Kutta 1901)."""

    n_steps: int = 1
    """Equal steps per interval."""

    def __post_init__(self) -> None:
        _require_steps(self.n_steps)

    def integrate(self, f: RightHandSide, s: ca.SX, x: ca.SX, width: ca.SX) -> Step:
        """From state x at s to s + width."""
        h, samples = width / self.n_steps, list[Sample]()
        for i in range(self.n_steps):
            start, middle, end = s + i * h, s + (i + 0.5) * h, s + (i + 1) * h
            k1 = f(start, x)
            x2 = x + h / 2 * k1
            k2 = f(middle, x2)
            x3 = x + h / 2 * k2
            k3 = f(middle, x3)
            x4 = x + h * k3
            k4 = f(end, x4)
            samples += [Sample(start, x, h / 6), Sample(middle, x2, h / 3)]
            samples += [Sample(middle, x3, h / 3), Sample(end, x4, h / 6)]
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return Step(x, samples)


@dataclass(frozen=True, kw_only=True)
class RadauIIA:
    """Implicit, stiffly accurate and L-stable, of order 2 n_stages - 1 (Hairer and Wanner 1996, sec. IV.5).

    Newton's method for the stages is written out, so the step stays an expression of a fixed number of iterations;
    with quadratic convergence from the rate at the start, four leave an error far below that of the step.
    """

    n_steps: int = 1
    n_stages: int = 2
    n_newton: int = 4

    def __post_init__(self) -> None:
        _require_steps(self.n_steps)
        if self.n_stages < 1 or self.n_newton < 1:
            raise ProblemError("RadauIIA needs at least one stage and one Newton iteration")

    def integrate(self, f: RightHandSide, s: ca.SX, x: ca.SX, width: ca.SX) -> Step:
        """From state x at s to s + width."""
        h, samples = width / self.n_steps, list[Sample]()
        points = radau_points(self.n_stages)
        weights = lagrange_integrals(points, np.array([1.0]))[0].tolist()
        for i in range(self.n_steps):
            start = s + i * h
            stages = self._stages(f, start, x, h)
            samples += [
                Sample(start + c * h, x_i, b * h) for c, b, x_i in zip(points.tolist(), weights, stages, strict=True)
            ]
            x = stages[-1]
        return Step(x, samples)

    def _stages(self, f: RightHandSide, s: ca.SX, x: ca.SX, h: ca.SX) -> list[ca.SX]:
        n, points = x.numel(), radau_points(self.n_stages)
        A = ca.DM(lagrange_integrals(points, points))
        unknown = ca.SX.sym("X", n, self.n_stages)
        rates = ca.horzcat(*[f(s + c * h, unknown[:, i]) for i, c in enumerate(points.tolist())])
        defect = ca.vec(unknown - ca.repmat(x, 1, self.n_stages) - h * ca.mtimes(rates, A.T))
        correction = ca.solve(ca.jacobian(defect, ca.vec(unknown)), defect)
        inputs = [unknown, *_other_symbols(correction, unknown)]
        newton = ca.Function("newton", inputs, [unknown - ca.reshape(correction, n, self.n_stages)])
        rate = f(s, x)
        guess = ca.horzcat(*[x + c * h * rate for c in points.tolist()])
        for _ in range(self.n_newton):
            guess = newton(guess, *inputs[1:])
        return ca.horzsplit(guess)


def _other_symbols(expression: ca.SX, known: ca.SX) -> list[ca.SX]:
    return [symbol for symbol in ca.symvar(expression) if not ca.depends_on(symbol, ca.vec(known))]


def _require_steps(n_steps: int) -> None:
    if n_steps < 1:
        raise ProblemError(f"an integrator needs at least one step per interval, got {n_steps}")
