"""Constraints, one after the other, each in the null space of those before (Algorithms 1 and 2)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .line_search import StepLengths, doubling_search
from .problem import Evaluations, numerical_gradient, numerical_jacobian
from .projection import null_space_projection

FLAT = 1e-10
"""Gradients below count as zero (the source's "approximately zero")."""
MET = 1e-10
"""Constraint values below count as zero."""


@dataclass(frozen=True, kw_only=True)
class Feasible:
    """Where the constraints are met as far as possible, and their gradients there."""

    x: np.ndarray
    """Point, shape (n,)."""
    equality_rows: np.ndarray
    """Gradients of the equalities, shape (n_ec, n)."""
    active: np.ndarray
    """Indices of the active inequalities, shape (n_a,)."""
    inequality_rows: np.ndarray
    """Their gradients, shape (n_a, n)."""


def meet_constraints(evaluations: Evaluations, x: np.ndarray, steps: StepLengths, near: float) -> Feasible:
    """Reduce violated constraints from x, shape (n,); inequalities nearer than `near` (a distance in x) are active."""
    x, equality_rows = meet_equalities(evaluations, x, steps, near)
    return meet_inequalities(evaluations, x, equality_rows, steps, near)


def meet_equalities(
    evaluations: Evaluations, x: np.ndarray, steps: StepLengths, near: float
) -> tuple[np.ndarray, np.ndarray]:
    """Algorithm 1 from x, shape (n,): the new x and the gradients of all equalities, shape (n_ec, n).

    As printed, line 15 projects a gradient on the null space that its own row, appended in line 10, belongs to, which
    leaves nothing; the rows before it are meant (section 2.4). The costs of lines 26 to 33 are those of the last point.
    Gradients are computed for all constraints at once, after moves longer than `near` anew for those that follow: as in
    the source, a row is that of the point where its own constraint was looked at.
    """
    rows, seen = numerical_jacobian(evaluations.equality, x), x
    for k in range(evaluations.n_equality):
        error = abs(float(evaluations.equality(x)[k]))
        direction = -np.sign(evaluations.equality(x)[k]) * null_space_projection(rows[:k], rows[k])
        if not error > MET or not np.linalg.norm(direction) > FLAT * (1.0 + np.linalg.norm(rows[k])):
            continue
        moved = doubling_search(_Distance(evaluations.equality, k), x, direction, steps)
        if np.any(moved != x):
            far = np.linalg.norm(moved - seen) > near
            x = moved
            if far:
                rows[k + 1 :], seen = numerical_jacobian(evaluations.equality, x)[k + 1 :], x
    return x, rows


def meet_inequalities(
    evaluations: Evaluations, x: np.ndarray, equality_rows: np.ndarray, steps: StepLengths, near: float
) -> Feasible:
    """Algorithm 2 from x, shape (n,), with the equalities' gradients, shape (n_ec, n).

    As printed, line 24 follows the gradient of an equality; that of the inequality is meant. Inequalities within the
    distance `near` of their bound count as active, too: in the source a step that ends a hair inside of a bound forgets
    it and the next one runs into it again.
    """
    active: list[int] = []
    gradients: list[np.ndarray] = []
    rows = numerical_jacobian(evaluations.inequality, x)
    for k in range(evaluations.n_inequality):
        value = float(evaluations.inequality(x)[k])
        if not value > -near * np.linalg.norm(rows[k]) or not np.linalg.norm(rows[k]) > FLAT:
            continue
        row = rows[k] if value <= MET else numerical_gradient(lambda x, k=k: float(evaluations.inequality(x)[k]), x)
        against = [other for other in gradients if other @ row < 0.0]
        active.append(k)
        gradients.append(row)
        direction = -null_space_projection(np.vstack([equality_rows, *against]), row)
        if value > MET and np.linalg.norm(direction) > FLAT * (1.0 + np.linalg.norm(row)):
            x = doubling_search(_Distance(evaluations.inequality, k), x, direction, steps)
    inequality_rows = np.array(gradients).reshape(len(gradients), len(x))
    return Feasible(
        x=x, equality_rows=equality_rows, active=np.array(active, dtype=int), inequality_rows=inequality_rows
    )


@dataclass(frozen=True)
class _Distance:
    """How far a constraint is from its bound, on either side."""

    constraints: Callable[[np.ndarray], np.ndarray]
    """Values of all constraints, shape (m,), at x, shape (n,)."""
    index: int

    def __call__(self, x: np.ndarray) -> float:
        return abs(float(self.constraints(x)[self.index]))
