"""Sparse nonlinear programs whose unknowns can be ordered along time."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np


class Pattern(NamedTuple):
    """Positions of the entries of a sparse matrix; repeated positions are summed."""

    rows: np.ndarray
    """Row of each entry, shape (nnz,)."""
    cols: np.ndarray
    """Column of each entry, shape (nnz,)."""


class Values(NamedTuple):
    """Objective and constraints at one point."""

    f: float
    g: np.ndarray
    """Equality constraints, shape (n_g,)."""
    c: np.ndarray
    """Inequality constraints, c >= 0, shape (n_c,)."""


class Derivatives(NamedTuple):
    """First and second derivatives at one point, entries in the order of the patterns."""

    grad: np.ndarray
    """Gradient of the objective, shape (n_w,)."""
    jac_g: np.ndarray
    """Entries of the Jacobian of g, shape (nnz_g,)."""
    jac_c: np.ndarray
    """Entries of the Jacobian of c, shape (nnz_c,)."""
    hess: np.ndarray
    """Entries of the Hessian of f + lam_g' g - lam_c' c, both triangles, shape (nnz_h,)."""
    gauss_newton: Callable[[], np.ndarray] | None = None
    """Gives entries of the Hessian, shape (nnz_h,), without the curvature of the constraints and of what criteria are
    functions of: positive semidefinite where the criteria are convex. None where the problem has no such form."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SparseStructure:
    """Sizes, sparsity and an order of the unknowns in which the KKT matrix is block tridiagonal."""

    n_w: int
    n_g: int
    n_c: int
    jac_g: Pattern
    jac_c: Pattern
    hess: Pattern
    order: np.ndarray
    """Order of (w, lam_g) along time: a permutation, shape (n_w + n_g,)."""
    blocks: np.ndarray
    """Sizes of consecutive blocks of that order of which only neighbours are coupled, shape (n_blocks,)."""


class SparseProblem(Protocol):
    r"""Nonlinear program with inequalities of one sign.

    .. math::

        \underset{w}{\text{minimize}} \; f(w) \quad \text{subject to} \quad g(w) = 0, \; c(w) \ge 0
    """

    @property
    def structure(self) -> SparseStructure:
        """Sizes and sparsity, the same for every call."""
        ...

    def values(self, w: np.ndarray) -> Values:
        """Evaluate objective and constraints at w, shape (n_w,)."""
        ...

    def derivatives(self, w: np.ndarray, lam_g: np.ndarray, lam_c: np.ndarray) -> Derivatives:
        """Evaluate the derivatives at w, shape (n_w,), for multipliers of shapes (n_g,) and (n_c,)."""
        ...


def multiply(pattern: Pattern, entries: np.ndarray, x: np.ndarray, n_rows: int) -> np.ndarray:
    """Product of a sparse matrix given by its entries with x, shape (n_cols,); result of shape (n_rows,)."""
    return np.bincount(pattern.rows, weights=entries * x[pattern.cols], minlength=n_rows)


def multiply_transposed(pattern: Pattern, entries: np.ndarray, x: np.ndarray, n_cols: int) -> np.ndarray:
    """Product of its transpose with x, shape (n_rows,); result of shape (n_cols,)."""
    return np.bincount(pattern.cols, weights=entries * x[pattern.rows], minlength=n_cols)


def pairs_in_rows(rows: np.ndarray, entries: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All ordered pairs of entries, shape (nnz,), that share a row, shape (nnz,): (row, first, second)."""
    order = np.argsort(rows, kind="stable")
    rows, entries = rows[order], entries[order]
    counts = np.bincount(rows) if len(rows) else np.zeros(0, dtype=np.int64)
    starts = np.cumsum(counts) - counts
    n_pairs = counts**2
    row = np.repeat(np.arange(len(counts)), n_pairs)
    within = np.arange(n_pairs.sum()) - np.repeat(np.cumsum(n_pairs) - n_pairs, n_pairs)
    return row, entries[starts[row] + within // counts[row]], entries[starts[row] + within % counts[row]]
