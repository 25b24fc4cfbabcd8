"""Constrained problems of which function values alone are known."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...errors import ProblemError

_FAILURES = (ArithmeticError, ValueError, np.linalg.LinAlgError)
"""What numerical code raises where it has no value; counts as a value that is not a number."""


def no_constraints(x: np.ndarray) -> np.ndarray:
    """No rows for any x, shape (n,): result (0,)."""
    del x
    return np.zeros(0)


def nothing_to_update(x: np.ndarray) -> None:
    """Interim function of problems without internal state, x of shape (n,)."""
    del x


@dataclass(frozen=True, kw_only=True)
class BlackBoxProblem:
    r"""Minimise a cost under constraints, (3) of the source.

    .. math::

        \underset{x}{\text{minimize}} \; f(x) \quad \text{subject to} \quad g_{ec}(x) = 0, \; g_{ic}(x) \le 0

    The functions may return numbers that are not finite, or raise arithmetic errors, where they have no value.
    """

    cost: Callable[[np.ndarray], float]
    """Cost f of x, shape (n,)."""
    equality: Callable[[np.ndarray], np.ndarray] = no_constraints
    """Equalities g_ec of x, shape (n,), most important first: shape (n_ec,)."""
    inequality: Callable[[np.ndarray], np.ndarray] = no_constraints
    """Inequalities g_ic of x, shape (n,), most important first: shape (n_ic,)."""
    interim: Callable[[np.ndarray], None] = nothing_to_update
    """Called with x, shape (n,), once per outer iteration, to update what the others share (section 3)."""
    equality_names: tuple[str, ...] = ()
    """Names for messages; numbers are used when left empty."""
    inequality_names: tuple[str, ...] = ()
    """Names for messages; numbers are used when left empty."""


class Evaluations:
    """Calls of a problem's functions, counted and checked."""

    def __init__(self, problem: BlackBoxProblem, x: np.ndarray) -> None:
        self.problem, self.count = problem, 0
        self.n_equality = len(self._rows("equality", problem.equality, x, None))
        self.n_inequality = len(self._rows("inequality", problem.inequality, x, None))
        for kind, names, n in (
            ("equality", problem.equality_names, self.n_equality),
            ("inequality", problem.inequality_names, self.n_inequality),
        ):
            if names and len(names) != n:
                raise ProblemError(f"{kind}_names must have {n} entries, got {len(names)}")

    def cost(self, x: np.ndarray) -> float:
        """Cost at x, shape (n,); not a number where it has no value."""
        self.count += 1
        try:
            return float(self.problem.cost(x.copy()))
        except _FAILURES:
            return float("nan")

    def equality(self, x: np.ndarray) -> np.ndarray:
        """Equality constraints at x, shape (n,): result (n_ec,)."""
        return self._rows("equality", self.problem.equality, x, self.n_equality)

    def inequality(self, x: np.ndarray) -> np.ndarray:
        """Inequality constraints at x, shape (n,): result (n_ic,)."""
        return self._rows("inequality", self.problem.inequality, x, self.n_inequality)

    def equality_name(self, index: int) -> str:
        """Name for messages."""
        names = self.problem.equality_names
        return f"equality constraint '{names[index]}'" if names else f"equality constraint {index}"

    def inequality_name(self, index: int) -> str:
        """Name for messages."""
        names = self.problem.inequality_names
        return f"inequality constraint '{names[index]}'" if names else f"inequality constraint {index}"

    def _rows(
        self, kind: str, function: Callable[[np.ndarray], np.ndarray], x: np.ndarray, n: int | None
    ) -> np.ndarray:
        self.count += function is not no_constraints
        try:
            rows = np.asarray(function(x.copy()), dtype=float)
        except _FAILURES as error:
            if n is None:
                raise ProblemError(f"the {kind} constraints have no value at the start: {error}") from error
            return np.full(n, np.nan)
        if rows.ndim != 1 or (n is not None and len(rows) != n):
            raise ProblemError(f"the {kind} constraints must have shape ({'n' if n is None else n},), got {rows.shape}")
        return rows


def numerical_jacobian(function: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    """Central differences of a function (n,) -> (m,) at x; result (m, n), one-sided where a neighbour has no value."""
    steps = np.finfo(float).eps ** (1 / 3) * (1.0 + np.abs(x))
    columns: list[np.ndarray] = []
    for i, h in enumerate(steps):
        ahead, behind = x.copy(), x.copy()
        ahead[i] += h
        behind[i] -= h
        after, before = function(ahead), function(behind)
        column = (after - before) / (ahead[i] - behind[i])
        if not np.all(np.isfinite(column)):
            here = function(x)
            forward, backward = (after - here) / h, (here - before) / h
            column = np.where(np.isfinite(column), column, np.where(np.isfinite(forward), forward, backward))
        columns.append(column)
    return np.array(columns).reshape(len(x), -1).T


def numerical_gradient(function: Callable[[np.ndarray], float], x: np.ndarray) -> np.ndarray:
    """Central differences of a scalar function at x, shape (n,)."""
    return numerical_jacobian(lambda x: np.array([function(x)]), x)[0]
