"""KKT systems that are banded in time: assembly and LU factorisation in linear time.

LAPACK's banded LU with partial pivoting costs O(n k^2) for half-bandwidth k. It needs no assumption on which
constraints of a stage are independent, in contrast to Riccati recursions, and its result does not depend on timing.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

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


@lru_cache(maxsize=64)
def kkt_assembly(structure: SparseStructure) -> "KKTAssembly":
    """The assembly of a structure; a structure is the same object in all problems that share it."""
    return KKTAssembly(structure)


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
        g_rows = s.n_w + s.jac_g.rows
        rows = [s.hess.rows, s.jac_c.cols[first], g_rows, s.jac_g.cols]
        cols = [s.hess.cols, s.jac_c.cols[second], s.jac_g.cols, g_rows]
        return Pattern(self.position[np.concatenate(rows)], self.position[np.concatenate(cols)])

    @cached_property
    def bandwidth(self) -> int:
        """Half-bandwidth of the ordered KKT matrix; at least one, so that the first place in memory is fill-in."""
        return int(np.max(np.abs(self._pattern.rows - self._pattern.cols), initial=1))

    @cached_property
    def _flat(self) -> np.ndarray:
        # LAPACK's band storage, column-major: entry (i, j) lies at row kl + ku + i - j of column j.
        k = self.bandwidth
        rows, cols = self._pattern
        return cols * (3 * k + 1) + 2 * k + rows - cols

    def band(self, derivatives: tuple[np.ndarray, np.ndarray, np.ndarray], sigma: np.ndarray) -> np.ndarray:
        """K in LAPACK's band storage, one row per column of K, shape (n, 3 bandwidth + 1).

        From entries (hess, jac_g, jac_c) of shapes (nnz,) and barrier weights sigma (n_c,), without regularisation.
        """
        hess, jac_g, jac_c = derivatives
        s, k = self.structure, self.bandwidth
        first, second, row = self._pairs
        entries = np.concatenate([hess, jac_c[first] * jac_c[second] * sigma[row], jac_g, jac_g])
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
        flat = band.ravel()
        count, factor, pivots = 0, np.zeros((0, 0)), np.zeros(0)
        for diagonal, below, used in self._blocks:
            schur = flat[diagonal]
            if len(used):
                unit = np.zeros((len(factor), len(used)), order="F")
                unit[used, np.arange(len(used))] = 1.0
                inverse, _ = lapack.dsytrs(factor, pivots, unit, lower=True)
                coupling = flat[below]
                schur -= coupling @ inverse[used] @ coupling.T
            # A symmetric matrix is its own transpose: the view is what Fortran wants.
            factor, pivots, _ = lapack.dsytrf(schur.T, lower=True, overwrite_a=True)
            single = pivots > 0
            count += int(np.sum(np.diag(factor)[single] < 0.0)) + int(np.sum(~single)) // 2
        return count

    @cached_property
    def _blocks(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        # Per block: places of its entries, of its coupling to the block before, and the columns of that in use.
        ends = np.cumsum(self.structure.blocks)
        starts = ends - self.structure.blocks
        lower = self._pattern.rows >= self._pattern.cols
        rows, cols = self._pattern.rows[lower], self._pattern.cols[lower]
        blocks: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        for k, (start, end) in enumerate(zip(starts, ends, strict=True)):
            outside = cols[(rows >= start) & (rows < end) & (cols < start)]
            used = np.unique(outside)
            own = np.arange(start, end)
            before = int(starts[k - 1]) if k else 0
            blocks.append((self._places(own, own), self._places(own, used), used - before))
        return blocks

    def _places(self, rows: np.ndarray, cols: np.ndarray) -> np.ndarray:
        """Places in the band's memory of entries (rows x cols); those outside it point to a zero of the fill-in."""
        k = self.bandwidth
        i, j = rows[:, None], cols[None, :]
        return np.where(np.abs(i - j) <= k, j * (3 * k + 1) + np.clip(2 * k + i - j, 0, 3 * k), 0)

    def shifted(self, band: np.ndarray, delta: tuple[float, float]) -> np.ndarray:
        """Copy of K, shape (n, 3 bandwidth + 1), delta_w added for variables and delta_g taken for equations."""
        s = self.structure
        moved = band.copy()
        shift = np.concatenate([np.full(s.n_w, delta[0]), np.full(s.n_g, -delta[1])])
        moved[self.position, 2 * self.bandwidth] += shift
        return moved
