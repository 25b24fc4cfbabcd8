"""KKT systems that are banded in time: assembly and LU factorisation in linear time.

LAPACK's banded LU with partial pivoting costs O(n k^2) for half-bandwidth k. It needs no assumption on which
constraints of a stage are independent, in contrast to Riccati recursions, and its result does not depend on timing.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from ..errors import ProblemError
from .sparse_problem import Derivatives, Pattern, SparseStructure, pairs_in_rows

AUGMENTATION = 1e5
"""Weight of the constraints, relative to the largest second derivative, in the convexity test."""


@dataclass(frozen=True, kw_only=True)
class BandedLU:
    """Factorised banded matrix."""

    lu: np.ndarray
    """Factors as LAPACK stores them, shape (2 kl + ku + 1, n)."""
    pivots: np.ndarray
    """Row interchanges, shape (n,)."""
    bandwidth: int
    order: np.ndarray
    """Position in time of each row of the unordered system, shape (n,)."""

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solve for one right-hand side, shape (n,), or several, shape (n, m)."""
        ordered = np.empty_like(rhs)
        ordered[self.order] = rhs
        k = self.bandwidth
        x, _ = lapack.dgbtrs(self.lu, k, k, ordered, self.pivots)
        return np.asarray(x)[self.order]


@dataclass(frozen=True)
class KKTAssembly:
    r"""Scatters derivative entries into the condensed KKT matrix.

    .. math::

        K = \begin{pmatrix} H + J_c^T \Sigma J_c + \delta_w I & J_g^T \\ J_g & -\delta_g I \end{pmatrix}
    """

    structure: SparseStructure

    @cached_property
    def position(self) -> np.ndarray:
        """Place of each unknown (w, lam_g) in the order along time, shape (n,)."""
        n = self.structure.n_w + self.structure.n_g
        if not np.array_equal(np.sort(self.structure.order), np.arange(n)):
            raise ProblemError(f"order must be a permutation of {n} unknowns (variables, then equality multipliers)")
        place = np.empty(n, dtype=np.int64)
        place[self.structure.order] = np.arange(n)
        return place

    @cached_property
    def _pairs(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        # Entries of J_c that share a row: (first, second, row). Rows of c are short.
        rows = self.structure.jac_c.rows
        row, first, second = pairs_in_rows(rows, np.arange(len(rows)))
        return first, second, row

    @cached_property
    def _pattern(self) -> Pattern:
        s = self.structure
        first, second, _ = self._pairs
        diagonal = np.arange(s.n_w + s.n_g)
        g_rows = s.n_w + s.jac_g.rows
        rows = [s.hess.rows, s.jac_c.cols[first], g_rows, s.jac_g.cols, diagonal]
        cols = [s.hess.cols, s.jac_c.cols[second], s.jac_g.cols, g_rows, diagonal]
        return Pattern(self.position[np.concatenate(rows)], self.position[np.concatenate(cols)])

    @cached_property
    def _primal(self) -> tuple[np.ndarray, np.ndarray, int]:
        # Lower band of the primal matrix: place in LAPACK's storage, which entries are used, bandwidth.
        s = self.structure
        first, second, _ = self._pairs
        diagonal = np.arange(s.n_w)
        rank = np.argsort(np.argsort(self.position[: s.n_w]))
        rows = rank[np.concatenate([s.hess.rows, s.gram.rows, s.jac_c.cols[first], diagonal])]
        cols = rank[np.concatenate([s.hess.cols, s.gram.cols, s.jac_c.cols[second], diagonal])]
        lower = np.flatnonzero(rows >= cols)
        k = int(np.max(rows - cols))
        return cols[lower] * (k + 1) + rows[lower] - cols[lower], lower, k

    def is_convex(self, derivatives: Derivatives, sigma: np.ndarray, delta: float) -> bool:
        r"""Whether :math:`H + J_c^T \Sigma J_c + \delta I` is positive definite on the null space of J_g.

        Sufficient: a Cholesky factor of the matrix plus :math:`\rho J_g^T D J_g` exists (Debreu's lemma); with
        rho as large as rounding allows it is practically necessary too.
        """
        first, second, row = self._pairs
        place, lower, k = self._primal
        rho = AUGMENTATION * max(1.0, float(np.max(np.abs(derivatives.hess), initial=0.0)))
        jac_c = derivatives.jac_c
        entries = np.concatenate(
            [
                derivatives.hess,
                rho * derivatives.gram,
                jac_c[first] * jac_c[second] * sigma[row],
                np.full(self.structure.n_w, delta),
            ]
        )[lower]
        band = np.bincount(place, weights=entries, minlength=self.structure.n_w * (k + 1))
        _, info = lapack.dpbtrf(band.reshape(-1, k + 1).T, lower=True, overwrite_ab=True)
        return info == 0

    @cached_property
    def bandwidth(self) -> int:
        """Half-bandwidth of the ordered KKT matrix."""
        return int(np.max(np.abs(self._pattern.rows - self._pattern.cols)))

    @cached_property
    def _flat(self) -> np.ndarray:
        # LAPACK's band storage, column-major: entry (i, j) lies at row kl + ku + i - j of column j.
        k = self.bandwidth
        rows, cols = self._pattern
        return cols * (3 * k + 1) + 2 * k + rows - cols

    def factorise(
        self, derivatives: tuple[np.ndarray, np.ndarray, np.ndarray], sigma: np.ndarray, delta: tuple[float, float]
    ) -> BandedLU | None:
        """Factorise K for entries (hess, jac_g, jac_c), barrier weights sigma (n_c,) and (delta_w, delta_g).

        Returns None where the matrix is singular to working precision or not finite.
        """
        hess, jac_g, jac_c = derivatives
        s, k = self.structure, self.bandwidth
        first, second, row = self._pairs
        regularisation = np.concatenate([np.full(s.n_w, delta[0]), np.full(s.n_g, -delta[1])])
        entries = np.concatenate([hess, jac_c[first] * jac_c[second] * sigma[row], jac_g, jac_g, regularisation])
        n = s.n_w + s.n_g
        band = np.bincount(self._flat, weights=entries, minlength=n * (3 * k + 1))
        if not np.all(np.isfinite(band)):
            return None
        lu, pivots, info = lapack.dgbtrf(band.reshape(n, 3 * k + 1).T, k, k, overwrite_ab=True)
        return None if info != 0 else BandedLU(lu=lu, pivots=pivots, bandwidth=k, order=self.position)

    def multiply(self, pattern: Pattern, entries: np.ndarray, x: np.ndarray, n_rows: int) -> np.ndarray:
        """Product of a sparse matrix given by its entries with x, shape (n_cols,); result of shape (n_rows,)."""
        return np.bincount(pattern.rows, weights=entries * x[pattern.cols], minlength=n_rows)

    def multiply_transposed(self, pattern: Pattern, entries: np.ndarray, x: np.ndarray, n_cols: int) -> np.ndarray:
        """Product of its transpose with x, shape (n_rows,); result of shape (n_cols,)."""
        return np.bincount(pattern.cols, weights=entries * x[pattern.rows], minlength=n_cols)
