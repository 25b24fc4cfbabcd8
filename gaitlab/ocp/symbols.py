"""Checks shared by all pieces of the problem language: shapes, and symbols that nobody declared."""

from collections.abc import Iterable

import casadi as ca
import numpy as np

from ..errors import ProblemError


def require_shape(what: str, expression: ca.SX, shape: tuple[int, int]) -> None:
    """Refuse an expression of another shape."""
    if expression.shape != shape:
        raise ProblemError(f"{what} must have shape {shape}, got {expression.shape}")


def require_symbols(what: str, symbol: ca.SX) -> None:
    """Refuse a column that is not made of symbols, for instance an expression or a number."""
    if symbol.numel() and not (symbol.shape[1] == 1 and symbol.is_valid_input()):
        raise ProblemError(f"{what} must be a column of symbols, got {symbol}")


def require_known(what: str, expression: ca.SX, known: Iterable[ca.SX]) -> None:
    """Refuse an expression that uses symbols other than the known ones."""
    column = ca.vertcat(*known)
    used = ca.symvar(expression)
    free = [s.name() for s in used if not ca.depends_on(s, column)] if column.numel() else [s.name() for s in used]
    if free:
        allowed = ", ".join(element_names(column)) or "none"
        raise ProblemError(f"{what} uses {', '.join(free)}; symbols that it may use: {allowed}")


def require_bounds(what: str, lower: np.ndarray, upper: np.ndarray, n: int) -> None:
    """Refuse bounds that have not shape (n,), that cross or that are no numbers."""
    for side, bound in (("lower", lower), ("upper", upper)):
        if bound.shape != (n,):
            raise ProblemError(f"the {side} bounds of {what} must have shape ({n},), got {bound.shape}")
    crossed = np.flatnonzero(~(lower <= upper))
    if crossed.size:
        i = int(crossed[0])
        raise ProblemError(f"bound {i} of {what} is empty: from {lower[i]:g} to {upper[i]:g}")


def element_names(column: ca.SX) -> list[str]:
    """Names of the symbols in a column, in order."""
    return [column[i].name() for i in range(column.numel())]
