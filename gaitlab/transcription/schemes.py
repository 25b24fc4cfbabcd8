"""What happens inside an interval: integrated from its left node, or collocated."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import casadi as ca
import numpy as np

from ..errors import ProblemError
from .integrators import Integrator, RungeKutta4, Sample
from .polynomials import (
    lagrange_coefficients,
    lagrange_integrals,
    lagrange_slopes,
    lagrange_values,
    legendre_points,
    radau_points,
)


class Discretised(NamedTuple):
    """An interval as expressions of its unknowns."""

    defects: ca.SX
    """Zero for a solution of the differential equation; the last n_x are those of continuity, shape (n_d, 1)."""
    samples: list[Sample]
    """Quadrature of the running criteria over s in [0, 1]."""


class Ends(NamedTuple):
    """States of an interval."""

    left: ca.SX
    """State at the left node, shape (n_x, 1)."""
    inside: ca.SX
    """Unknown states inside, shape (n_x, n_inside)."""
    right: ca.SX
    """State at the right node, shape (n_x, 1)."""


RightHandSide = Callable[[ca.SX, ca.SX], ca.SX]


class Scheme(Protocol):
    """Discretisation of dx/ds = f(s, x) on s in [0, 1]."""

    @property
    def n_inside(self) -> int:
        """Unknown states inside an interval."""
        ...

    @property
    def path_times(self) -> tuple[float, ...]:
        """Where path constraints are imposed in every interval."""
        ...

    @property
    def path_at_end(self) -> bool:
        """Whether they are imposed at the end of the stage besides."""
        ...

    def inside_times(self) -> np.ndarray:
        """Where the unknown states inside are, shape (n_inside,)."""
        ...

    def discretise(self, f: RightHandSide, x: Ends) -> Discretised:
        """Defects and quadrature of the interval."""
        ...

    def state(self, f: RightHandSide, x: Ends, s: ca.SX) -> ca.SX:
        """State at s, shape (n_x, 1)."""
        ...


@dataclass(frozen=True, kw_only=True)
class Shooting:
    """Integrated from the left node."""

    integrator: Integrator = RungeKutta4()
    n_inside: int = 0
    path_times: tuple[float, ...] = (0.0,)
    path_at_end: bool = True

    def inside_times(self) -> np.ndarray:
        """None, shape (0,)."""
        return np.zeros(0)

    def discretise(self, f: RightHandSide, x: Ends) -> Discretised:
        """Defect: the state reached minus the right node's."""
        step = self.integrator.integrate(f, ca.SX(0), x.left, ca.SX(1))
        return Discretised(step.x - x.right, step.samples)

    def state(self, f: RightHandSide, x: Ends, s: ca.SX) -> ca.SX:
        """State reached at s, shape (n_x, 1)."""
        return self.integrator.integrate(f, ca.SX(0), x.left, s).x


@dataclass(frozen=True, kw_only=True)
class Collocation:
    """Polynomial of degree `degree` per element that obeys the differential equation at `degree` points.

    At nodes the error is of order 2 degree for Legendre and 2 degree - 1 for Radau points (Hairer, Lubich, Wanner 2006,
    sec. II.1.2).
    """

    degree: int = 3
    points: Literal["radau", "legendre"] = "radau"
    n_elements: int = 1
    """Elements per interval; the control's shape and bounds belong to intervals."""

    def __post_init__(self) -> None:
        if self.n_elements < 1:
            raise ProblemError(f"collocation needs at least one element per interval, got {self.n_elements}")

    @property
    def nodes(self) -> np.ndarray:
        """Collocation points of an element, shape (degree,)."""
        return radau_points(self.degree) if self.points == "radau" else legendre_points(self.degree)

    @property
    def n_inside(self) -> int:
        """Unknown states inside an interval."""
        return self.degree * self.n_elements

    @property
    def path_times(self) -> tuple[float, ...]:
        """Path constraints are imposed at all collocation points."""
        return tuple(self.inside_times())

    @property
    def path_at_end(self) -> bool:
        """Only where the end is no collocation point."""
        return self.points == "legendre"

    def inside_times(self) -> np.ndarray:
        """Collocation points of all elements, shape (n_inside,)."""
        return np.concatenate([(i + self.nodes) / self.n_elements for i in range(self.n_elements)])

    def discretise(self, f: RightHandSide, x: Ends) -> Discretised:
        """Defects: slopes of the polynomials minus f, then continuity."""
        basis = np.append(0.0, self.nodes)
        slopes, ends = lagrange_slopes(basis, self.nodes), lagrange_values(basis, np.array([1.0]))
        weights = lagrange_integrals(self.nodes, np.array([1.0]))[0]
        h, defects, samples, start = 1.0 / self.n_elements, list[ca.SX](), list[Sample](), x.left
        for i in range(self.n_elements):
            inside = x.inside[:, i * self.degree : (i + 1) * self.degree]
            values = ca.horzcat(start, inside)
            for j, node in enumerate(self.nodes):
                s = ca.SX((i + node) * h)
                defects.append(ca.mtimes(values, ca.DM(slopes[j])) - h * f(s, inside[:, j]))
                samples.append(Sample(s, inside[:, j], ca.SX(weights[j] * h)))
            start = ca.mtimes(values, ca.DM(ends[0])) if self.points == "legendre" else inside[:, -1]
        return Discretised(ca.vertcat(*defects, start - x.right), samples)

    def state(self, f: RightHandSide, x: Ends, s: ca.SX) -> ca.SX:
        """Value of the polynomial of the element that holds s, shape (n_x, 1)."""
        del f  # Unused.
        coefficients = ca.DM(lagrange_coefficients(np.append(0.0, self.nodes)))
        ends = ca.DM(lagrange_values(np.append(0.0, self.nodes), np.array([1.0]))[0])
        start, result = x.left, ca.SX.zeros(x.left.numel())
        for i in range(self.n_elements):
            values = ca.horzcat(start, x.inside[:, i * self.degree : (i + 1) * self.degree])
            r = s * self.n_elements - i
            value = ca.mtimes([values, coefficients, ca.vertcat(*[r**k for k in range(self.degree + 1)])])
            result = value if i == 0 else ca.if_else(r >= 0, value, result)
            start = ca.mtimes(values, ends)
        return result
