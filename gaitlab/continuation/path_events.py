"""What is looked for along a path: each event is a number whose sign changes at the point looked for."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import sparse

from .bordered import NullPair, bordered, determinant_sign, null_pair, singularity
from .extended_system import PathSystem


@dataclass(frozen=True, kw_only=True, eq=False)
class PathPoint:
    """A corrected point of a path with its tangent."""

    x: np.ndarray
    """Unknowns, shape (n,)."""
    tangent: np.ndarray
    """Unit tangent in the system's inner product, shape (n,)."""
    newton_steps: int = 0


Measure = Callable[[PathSystem, PathPoint], float]


class Event(Protocol):
    """A kind of point."""

    @property
    def name(self) -> str:
        """Name under which located points are listed."""
        ...

    @property
    def stops(self) -> bool:
        """Whether the path ends there."""
        ...

    def test(self, system: PathSystem, point: PathPoint) -> float:
        """A number whose sign changes there."""
        ...

    def measure(self, system: PathSystem, near: PathPoint) -> Measure:
        """A function that goes through zero there, for points near a given one."""
        ...


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """A parameter takes a value."""

    parameter: str
    value: float = 0.0
    stops: bool = False

    @property
    def name(self) -> str:
        """Parameter and value."""
        return f"{self.parameter} = {self.value:g}"

    def test(self, system: PathSystem, point: PathPoint) -> float:
        """Distance from the value."""
        return system.parameter(point.x, self.parameter) - self.value

    def measure(self, system: PathSystem, near: PathPoint) -> Measure:
        """The test itself."""
        del system, near  # Unused.
        return self.test


@dataclass(frozen=True, kw_only=True)
class Fold:
    """A parameter has a turning point: its derivative along the path vanishes."""

    parameter: str
    stops: bool = False

    @property
    def name(self) -> str:
        """Fold of which parameter."""
        return f"fold of {self.parameter}"

    def test(self, system: PathSystem, point: PathPoint) -> float:
        """Derivative of the parameter with respect to arc length."""
        return float(system.parameter_gradient(point.x, self.parameter) @ point.tangent)

    def measure(self, system: PathSystem, near: PathPoint) -> Measure:
        """The test itself."""
        del system, near  # Unused.
        return self.test


@dataclass(frozen=True, kw_only=True)
class BranchPoint:
    """Another path crosses this one: the Jacobian, bordered by the tangent, is singular."""

    stops: bool = False
    name: str = "branch point"

    def test(self, system: PathSystem, point: PathPoint) -> float:
        """Sign of the determinant."""
        return float(determinant_sign(tangent_matrix(system, point)))

    def measure(self, system: PathSystem, near: PathPoint) -> Measure:
        """Smooth measure of singularity with the sign of the determinant."""
        pair = null_pair(tangent_matrix(system, near))

        def signed(s: PathSystem, p: PathPoint) -> float:
            matrix = tangent_matrix(s, p)
            return determinant_sign(matrix) * _size(matrix, pair)

        return signed


def _size(matrix: sparse.csc_matrix, pair: NullPair | None) -> float:
    g = singularity(matrix, pair) if pair is not None else None
    return 1.0 if g is None else abs(g)


@dataclass(frozen=True, kw_only=True)
class TestFunction:
    """Any function of the unknowns x, shape (n,), whose sign changes."""

    __test__ = False  # The name is the field's word; pytest shall not collect it.

    name: str
    function: Callable[[np.ndarray], float]
    """Of the unknowns, shape (n,)."""
    stops: bool = False

    def test(self, system: PathSystem, point: PathPoint) -> float:
        """The function itself."""
        return self.function(point.x)

    def measure(self, system: PathSystem, near: PathPoint) -> Measure:
        """The test itself."""
        del system, near  # Unused.
        return self.test


def tangent_matrix(system: PathSystem, point: PathPoint) -> sparse.csc_matrix:
    """Jacobian at a point with the (weighted) tangent as last row, shape (n, n)."""
    return bordered(system.jacobian(point.x), system.weights * point.tangent)
