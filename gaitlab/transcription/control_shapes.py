"""How controls run between nodes."""

from typing import Protocol

import casadi as ca


class ControlShape(Protocol):
    """Control on one interval from coefficients at its nodes."""

    per_node: int
    """Coefficients per control at a node; the first is the control's value."""
    joined: bool
    """Whether the right node's coefficients matter, so that the control is continuous."""

    def value(self, left: ca.SX, right: ca.SX, s: ca.SX, width: ca.SX) -> ca.SX:
        """Control at the fraction s of an interval whose width is a fraction of the stage.

        Coefficients have the shape (n_u, per_node), the result (n_u, 1).
        """
        ...

    def inner(self, left: ca.SX, right: ca.SX, width: ca.SX) -> ca.SX:
        """Values to bound, besides those at nodes, so that the control obeys its bounds everywhere; shape (n, n_u)."""
        ...


class Constant:
    """Piecewise constant."""

    per_node = 1
    joined = False

    def value(self, left: ca.SX, right: ca.SX, s: ca.SX, width: ca.SX) -> ca.SX:
        """The left coefficient, shape (n_u, 1)."""
        del right, s, width  # Unused.
        return left

    def inner(self, left: ca.SX, right: ca.SX, width: ca.SX) -> ca.SX:
        """Nothing."""
        del right, width  # Unused.
        return ca.SX(0, left.shape[0])


class Linear:
    """Piecewise linear and continuous."""

    per_node = 1
    joined = True

    def value(self, left: ca.SX, right: ca.SX, s: ca.SX, width: ca.SX) -> ca.SX:
        """Between both coefficients, shape (n_u, 1)."""
        del width  # Unused.
        return (1 - s) * left + s * right

    def inner(self, left: ca.SX, right: ca.SX, width: ca.SX) -> ca.SX:
        """Nothing: a line lies between its ends."""
        del right, width  # Unused.
        return ca.SX(0, left.shape[0])


class Cubic:
    """Piecewise cubic with continuous slope: coefficients are the value and its derivative by the stage's fraction."""

    per_node = 2
    joined = True

    def value(self, left: ca.SX, right: ca.SX, s: ca.SX, width: ca.SX) -> ca.SX:
        """Hermite polynomial, shape (n_u, 1), in Bernstein's form."""
        first, second = self._middle(left, right, width)
        r = 1 - s
        return r**3 * left[:, 0] + 3 * r**2 * s * first + 3 * r * s**2 * second + s**3 * right[:, 0]

    def inner(self, left: ca.SX, right: ca.SX, width: ca.SX) -> ca.SX:
        """Middle Bernstein coefficients: the curve lies in the hull of all four, shape (2, n_u)."""
        return ca.horzcat(*self._middle(left, right, width)).T

    def _middle(self, left: ca.SX, right: ca.SX, width: ca.SX) -> tuple[ca.SX, ca.SX]:
        return left[:, 0] + width / 3 * left[:, 1], right[:, 0] - width / 3 * right[:, 1]


CONSTANT, LINEAR, CUBIC = Constant(), Linear(), Cubic()
