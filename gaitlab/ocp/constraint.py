"""Bounds and constraints, at all times or at several points of time."""

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from ..errors import ProblemError
from .symbols import require_bounds, require_shape


@dataclass(frozen=True, kw_only=True, eq=False)
class Bounds:
    """Intervals, one per component; equal bounds fix a value, infinite ones leave it free.

    Raises:
        ProblemError: The shapes differ, an interval is empty or not a number.
    """

    lower: np.ndarray
    """Lower bounds, shape (n,)."""
    upper: np.ndarray
    """Upper bounds, shape (n,)."""

    def __post_init__(self) -> None:
        require_bounds("a vector", self.lower, self.upper, self.lower.size)

    @property
    def size(self) -> int:
        """Number of components."""
        return self.lower.size

    @property
    def fixed(self) -> np.ndarray:
        """Which components are fixed, shape (n,)."""
        return self.lower == self.upper

    @property
    def finite(self) -> np.ndarray:
        """Which components have a bound, shape (n,)."""
        return np.isfinite(self.lower) | np.isfinite(self.upper)

    @staticmethod
    def none(n: int) -> "Bounds":
        """No bounds on n components."""
        return Bounds(lower=np.full(n, -np.inf), upper=np.full(n, np.inf))

    @staticmethod
    def symmetric(*values: float) -> "Bounds":
        """From -value to value, one per component."""
        value = np.array(values, dtype=float)
        return Bounds(lower=-value, upper=value)


@dataclass(frozen=True, kw_only=True, eq=False)
class Constraint:
    r""":math:`\underline{c} \le c \le \overline{c}`; equal bounds make an equality.

    Raises:
        ProblemError: The expression is no column, or the bounds do not fit it.
    """

    name: str
    expression: ca.SX
    """c, shape (n, 1)."""
    lower: np.ndarray
    """Lower bounds, shape (n,)."""
    upper: np.ndarray
    """Upper bounds, shape (n,)."""

    def __post_init__(self) -> None:
        n = self.expression.shape[0]
        require_shape(f"constraint '{self.name}'", self.expression, (n, 1))
        require_bounds(f"constraint '{self.name}'", self.lower, self.upper, n)

    def bounded(self) -> "Constraint":
        """The rows that have a bound: solvers return meaningless multipliers for the others."""
        rows = np.flatnonzero(np.isfinite(self.lower) | np.isfinite(self.upper)).tolist()
        return Constraint(
            name=self.name, expression=self.expression[rows, 0], lower=self.lower[rows], upper=self.upper[rows]
        )


NO_CONSTRAINT = Constraint(name="none", expression=ca.SX(0, 1), lower=np.zeros(0), upper=np.zeros(0))


@dataclass(frozen=True, kw_only=True, eq=False)
class Point:
    """A point of time, with symbols that stand for the state and control there.

    Raises:
        ProblemError: The time is outside the stage.
    """

    stage: int
    """Which stage."""
    time: float
    """Fraction of the stage's duration, from 0 to 1."""
    x: ca.SX
    """State at that time, symbols of shape (n_x, 1)."""
    u: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    """Control at that time (from the right), symbols of shape (n_u, 1)."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.time <= 1.0:
            raise ProblemError(f"a point's time must be a fraction of the stage, from 0 to 1, got {self.time:g}")


@dataclass(frozen=True, kw_only=True, eq=False)
class PointConstraint:
    """Constraint that couples states at several points, of the same or of different stages (Hatz 2014, (4.10))."""

    points: tuple[Point, ...]
    constraint: Constraint
    """Of the points' x and u, of q and of p."""
