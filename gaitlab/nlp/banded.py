"""KKT systems that are banded in time: assembly and LU factorisation in linear time.

LAPACK's banded LU with partial pivoting costs O(n k^2) for half-bandwidth k. It needs no assumption on which
constraints of a stage are independent, in contrast to Riccati recursions, and its result does not depend on timing.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from ..errors import ProblemError
from .sparse_problem import Pattern, SparseStructure, pairs_in_rows


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
    def bandwidth(self) -> int:
        """Half-bandwidth of the ordered KKT matrix."""
        return int(np.max(np.abs(self._pattern.rows - self._pattern.cols)))

    @cached_property
    def _flat(self) -> np.ndarray:
        # LAPACK's band storage, column-major: entry (i, j) lies at row kl + ku + i - j of column j.
        k = self.bandwidth
        rows, cols = self._pattern
        return cols * (3 * k + 1) + 2 * k + rows - cols

    def band(
        self, derivatives: tuple[np.ndarray, np.ndarray, np.ndarray], sigma: np.ndarray, delta: tuple[float, float]
    ) -> np.ndarray:
        """K in LAPACK's band storage, one row per column of K, shape (n, 3 bandwidth + 1).

        From entries (hess, jac_g, jac_c) of shapes (nnz,), barrier weights sigma (n_c,) and (delta_w, delta_g).
        """
        hess, jac_g, jac_c = derivatives
        s, k = self.structure, self.bandwidth
        first, second, row = self._pairs
        regularisation = np.concatenate([np.full(s.n_w, delta[0]), np.full(s.n_g, -delta[1])])
        entries = np.concatenate([hess, jac_c[first] * jac_c[second] * sigma[row], jac_g, jac_g, regularisation])
        n = s.n_w + s.n_g
        return np.bincount(self._flat, weights=entries, minlength=n * (3 * k + 1)).reshape(n, 3 * k + 1)

    def factorise(self, band: np.ndarray) -> BandedLU | None:
        """Factorise K, shape (n, 3 bandwidth + 1), which is overwritten; None where it is singular or not finite."""
        k = self.bandwidth
        if not np.all(np.isfinite(band)):
            return None
        lu, pivots, info = lapack.dgbtrf(band.T, k, k, overwrite_ab=True)
        return None if info != 0 else BandedLU(lu=lu, pivots=pivots, bandwidth=k, order=self.position)

    def negative_eigenvalues(self, band: np.ndarray) -> int:
        """Number of negative eigenvalues of K, shape (n, 3 bandwidth + 1).

        Block elimination along time: by Haynsworth's formula the inertia is the sum of those of the Schur complements
        S_k = D_k - B_k S_{k-1}^{-1} B_k', which LAPACK's Bunch-Kaufman factors tell. The minimiser's K has as many
        negative eigenvalues as there are equality constraints.
        """
        ends = np.cumsum(self.structure.blocks)
        count, previous = 0, None
        for start, end in zip(ends - self.structure.blocks, ends, strict=True):
            schur = self._block(band, (start, end), (start, end)).copy(order="F")
            if previous is not None:
                below = self._block(band, (start, end), previous[0])
                used = np.flatnonzero(np.any(below != 0.0, axis=0))
                unit = np.zeros((below.shape[1], len(used)), order="F")
                unit[used, np.arange(len(used))] = 1.0
                inverse, _ = lapack.dsytrs(previous[1], previous[2], unit, lower=True)
                schur -= below[:, used] @ inverse[used] @ below[:, used].T
            factor, pivots, _ = lapack.dsytrf(schur, lower=True)
            single = pivots > 0
            count += int(np.sum(np.diag(factor)[single] < 0.0)) + int(np.sum(~single)) // 2
            previous = ((start, end), factor, pivots)
        return count

    def _block(self, band: np.ndarray, rows: tuple[int, int], cols: tuple[int, int]) -> np.ndarray:
        """Dense view of the rows and columns [start, end) of K; entries outside the band are zero."""
        k = self.bandwidth
        i, j = np.arange(*rows)[:, None], np.arange(*cols)[None, :]
        inside = np.abs(i - j) <= k
        return np.where(inside, band[j, np.clip(2 * k + i - j, 0, 3 * k)], 0.0)

    def multiply(self, pattern: Pattern, entries: np.ndarray, x: np.ndarray, n_rows: int) -> np.ndarray:
        """Product of a sparse matrix given by its entries with x, shape (n_cols,); result of shape (n_rows,)."""
        return np.bincount(pattern.rows, weights=entries * x[pattern.cols], minlength=n_rows)

    def multiply_transposed(self, pattern: Pattern, entries: np.ndarray, x: np.ndarray, n_cols: int) -> np.ndarray:
        """Product of its transpose with x, shape (n_rows,); result of shape (n_cols,)."""
        return np.bincount(pattern.cols, weights=entries * x[pattern.rows], minlength=n_cols)
