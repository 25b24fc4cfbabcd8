r"""KKT systems that are block tridiagonal along time: assembly, factorisation, inertia and solution in linear time.

The matrix is eliminated block by block, S_k = D_k - B_k S_{k-1}^{-1} B_k', each S_k by LAPACK's Bunch-Kaufman method,
so that one pass gives the factors and, by Haynsworth's formula, the inertia. Nothing pivots across blocks: solutions
are refined, and where a backward error stays large a banded LU with partial pivoting takes over.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import blas, lapack

from ..errors import ProblemError
from .sparse_problem import Pattern, SparseStructure, pairs_in_rows

ACCEPTED = 1e-11
"""Backward error beyond which the elimination by blocks is given up."""
REFINEMENTS = 2
"""Always done: beside barrier weights a small backward error says nothing about the rows of small entries, and the
sensitivities of a search for weights and states need those."""
SUSPICIOUS = 1e-15
"""Right-hand side over matrix times solution, below which the matrix may be singular to rounding."""
SINGULAR = 0.1
"""It is where one more refinement would change the solution by this share of it."""


class Block(NamedTuple):
    """Where a block lies in the order along time, and in memory."""

    rows: slice
    diagonal: slice
    """Of D_k, row by row; only its lower triangle is set."""
    coupling: slice
    """Of B_k in the columns `used`, row by row."""
    used: np.ndarray
    """Unknowns of the block before that this one is coupled to, counted within that block, shape (n_used,)."""


@lru_cache(maxsize=32)
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

    def _lower(self) -> tuple[np.ndarray, Pattern]:
        """Which of the entries (H, pairs of J_c, J_g) lie in the lower triangle along time, and where.

        Not kept: these are the longest tables of all.
        """
        s = self.structure
        first, second, _ = self._pairs
        rows = self.position[np.concatenate([s.hess.rows, s.jac_c.cols[first], s.n_w + s.jac_g.rows])]
        cols = self.position[np.concatenate([s.hess.cols, s.jac_c.cols[second], s.jac_g.cols])]
        n_symmetric = len(s.hess.rows) + len(first)
        # Both triangles of H are given, J_g only once.
        kept = np.flatnonzero((rows >= cols) | (np.arange(len(rows)) >= n_symmetric))
        return kept, Pattern(np.maximum(rows, cols)[kept], np.minimum(rows, cols)[kept])

    @cached_property
    def blocks(self) -> list[Block]:
        """The blocks along time."""
        return self._tables[0]

    @cached_property
    def _tables(self) -> tuple[list[Block], np.ndarray, np.ndarray]:
        """The blocks, which entries are kept, and their places in memory, both (n_kept,)."""
        kept, pattern = self._lower()
        block_of = np.repeat(np.arange(len(self.structure.blocks)), self.structure.blocks)
        blocks = self._blocks(pattern, block_of)
        return blocks, kept, _places(blocks, pattern, block_of)

    def _blocks(self, pattern: Pattern, block_of: np.ndarray) -> list[Block]:
        ends = np.cumsum(self.structure.blocks)
        rows, cols = pattern
        across = block_of[rows] > block_of[cols]
        if np.any(block_of[rows] > block_of[cols] + 1):
            raise ProblemError("only neighbouring blocks of the order along time may be coupled")
        found, place = list[Block](), 0
        for k, (end, n) in enumerate(zip(ends.tolist(), self.structure.blocks.tolist(), strict=True)):
            used = np.unique(cols[across & (block_of[rows] == k)]) - (ends[k - 2] if k > 1 else 0)
            middle, last = place + n * n, place + n * (n + len(used))
            found.append(Block(slice(end - n, end), slice(place, middle), slice(middle, last), used))
            place = last
        return found

    @cached_property
    def _diagonal(self) -> np.ndarray:
        """Places in memory of the diagonal, in the order of (w, lam_g), shape (n,)."""
        along = [b.diagonal.start + np.arange(b.rows.stop - b.rows.start) * (b.rows.stop - b.rows.start + 1)
                 for b in self.blocks]  # fmt: skip
        return np.concatenate(along)[self.position]

    def matrix(self, derivatives: tuple[np.ndarray, np.ndarray, np.ndarray], sigma: np.ndarray) -> np.ndarray:
        """Entries of K in memory, block by block, shape (n_entries,).

        From entries (hess, jac_g, jac_c) of shapes (nnz,) and barrier weights sigma (n_c,), without regularisation.
        """
        hess, jac_g, jac_c = derivatives
        first, second, row = self._pairs
        entries = np.concatenate([hess, jac_c[first] * jac_c[second] * sigma[row], jac_g])
        blocks, kept, places = self._tables
        return np.bincount(places, weights=entries[kept], minlength=blocks[-1].coupling.stop)

    def shifted(self, matrix: np.ndarray, delta: tuple[float, float]) -> np.ndarray:
        """Copy of K, shape (n_entries,), delta_w added for variables and delta_g taken for equations."""
        moved = matrix.copy()
        n_w = self.structure.n_w
        moved[self._diagonal[:n_w]] += delta[0]
        moved[self._diagonal[n_w:]] -= delta[1]
        return moved

    def factorise(self, matrix: np.ndarray) -> "KKTFactors | None":
        """Eliminate K, shape (n_entries,), along time; None where a block is singular or not finite."""
        if not np.all(np.isfinite(matrix)):
            return None
        eliminated, negative = list[_Eliminated](), 0
        for k, block in enumerate(self.blocks):
            n = block.rows.stop - block.rows.start
            schur = matrix[block.diagonal].reshape(n, n).copy()
            if k and len(block.used):
                coupling, before = matrix[block.coupling].reshape(n, -1), eliminated[-1].inverse
                schur -= coupling @ before[block.used] @ coupling.T
            # Its lower triangle, row by row, is the upper one of Fortran.
            factor, pivots, info = lapack.dsytrf(schur.T, lower=False, overwrite_a=True)
            if info != 0:
                return None
            used = self.blocks[k + 1].used if k + 1 < len(self.blocks) else np.zeros(0, dtype=np.int64)
            unit = np.zeros((n, len(used)), order="F")
            unit[used, np.arange(len(used))] = 1.0
            inverse = lapack.dsytrs(factor, pivots, unit, lower=False, overwrite_b=True)[0] if len(used) else unit
            eliminated.append(_Eliminated(factor, pivots, inverse))
            single = pivots > 0
            negative += int(np.sum(np.diag(factor)[single] < 0.0)) + int(np.sum(~single)) // 2
        return KKTFactors(self, matrix, eliminated, negative)

    @cached_property
    def bandwidth(self) -> int:
        """Half-bandwidth of the ordered KKT matrix."""
        rows, cols = self._lower()[1]
        return int(np.max(rows - cols, initial=1))

    def banded_lu(self, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """LAPACK's banded LU of K, shape (n_entries,), with pivots; None where it is singular."""
        k, (rows, cols), places = self.bandwidth, self._lower()[1], self._tables[2]
        band = np.zeros((3 * k + 1, len(self.position)), order="F")
        band[2 * k + rows - cols, cols] = matrix[places]
        band[2 * k + cols - rows, rows] = matrix[places]
        lu, pivots, info = lapack.dgbtrf(band, k, k, overwrite_ab=True)
        return None if info != 0 else (lu, pivots)


class _Eliminated(NamedTuple):
    """Bunch-Kaufman factors of S_k, and the columns of its inverse that the next block uses."""

    factor: np.ndarray
    """Factors, shape (n_k, n_k)."""
    pivots: np.ndarray
    """Interchanges, shape (n_k,)."""
    inverse: np.ndarray
    """Columns of the inverse, shape (n_k, n_used)."""


@dataclass(frozen=True, eq=False)
class KKTFactors:
    """Factorised KKT matrix."""

    assembly: KKTAssembly
    matrix: np.ndarray
    """Entries of K in memory, shape (n_entries,)."""
    eliminated: Sequence[_Eliminated]
    negative_eigenvalues: int
    """The minimiser's matrix has as many as there are equality constraints."""

    def solve(self, rhs: np.ndarray) -> np.ndarray | None:
        """Solve for one right-hand side, shape (n,), or several, shape (n, m); None where K is singular."""
        position = self.assembly.position
        ordered = np.empty((len(position), rhs.size // len(position)), order="F")
        ordered[position] = rhs.reshape(ordered.shape)
        x = self._refined(ordered)
        return None if x is None else x[position].reshape(rhs.shape)

    def _refined(self, b: np.ndarray) -> np.ndarray | None:
        x = self._eliminate(b)
        for _ in range(REFINEMENTS):
            x = x + self._eliminate(b - self._product(x))
        residual = b - self._product(x)
        error = float(np.max(_columns(residual) / (self._size * _columns(x) + _columns(b)), initial=0.0))
        return x if error <= ACCEPTED and not self._is_meaningless(x, b, self._eliminate) else self._pivoted(b)

    @cached_property
    def _size(self) -> float:
        return float(np.max(np.abs(self.matrix)))

    def _is_meaningless(self, x: np.ndarray, b: np.ndarray, solve: Callable[[np.ndarray], np.ndarray]) -> bool:
        suspicious = SUSPICIOUS * self._size * _columns(x) > _columns(b)
        if not np.any(suspicious):
            return False
        # Badly scaled matrices look like that, too.
        correction = solve(b - self._product(x))
        return bool(np.any(suspicious & ~(_columns(correction) <= SINGULAR * _columns(x))))

    def _eliminate(self, b: np.ndarray) -> np.ndarray:
        x = np.empty_like(b)
        blocks = self.assembly.blocks
        for k, (block, own) in enumerate(zip(blocks, self.eliminated, strict=True)):
            y = b[block.rows]
            if k and len(block.used):
                y = y - self._coupling(block) @ x[blocks[k - 1].rows][block.used]
            x[block.rows] = lapack.dsytrs(own.factor, own.pivots, y, lower=False)[0]
        for k in range(len(blocks) - 1, 0, -1):
            if len(blocks[k].used):
                pull = self._coupling(blocks[k]).T @ x[blocks[k].rows]
                x[blocks[k - 1].rows] -= self.eliminated[k - 1].inverse @ pull
        return x

    def _product(self, x: np.ndarray) -> np.ndarray:
        """K x along time, for x of shape (n, m)."""
        product, blocks = np.empty_like(x), self.assembly.blocks
        for k, block in enumerate(blocks):
            n = block.rows.stop - block.rows.start
            diagonal = self.matrix[block.diagonal].reshape(n, n)
            product[block.rows] = blas.dsymm(1.0, diagonal.T, x[block.rows], lower=False)
            if k and len(block.used):
                coupling, before = self._coupling(block), blocks[k - 1].rows
                product[block.rows] += coupling @ x[before][block.used]
                product[before.start + block.used] += coupling.T @ x[block.rows]
        return product

    def _coupling(self, block: Block) -> np.ndarray:
        return self.matrix[block.coupling].reshape(block.rows.stop - block.rows.start, -1)

    @cached_property
    def _lu(self) -> tuple[np.ndarray, np.ndarray] | None:
        return self.assembly.banded_lu(self.matrix)

    def _pivoted(self, b: np.ndarray) -> np.ndarray | None:
        if self._lu is None:
            return None
        (lu, pivots), k = self._lu, self.assembly.bandwidth

        def solve(rhs: np.ndarray) -> np.ndarray:
            return np.asarray(lapack.dgbtrs(lu, k, k, rhs, pivots)[0])

        x = solve(b)
        return None if not np.all(np.isfinite(x)) or self._is_meaningless(x, b, solve) else x


def _places(blocks: Sequence[Block], pattern: Pattern, block_of: np.ndarray) -> np.ndarray:
    """Place in memory of each kept entry, shape (n_kept,), from the block of each unknown along time, shape (n,)."""
    rows, cols = pattern
    places = np.empty(len(rows), dtype=np.int64)
    for k, block in enumerate(blocks):
        here = np.flatnonzero(block_of[rows] == k)
        row, col = rows[here] - block.rows.start, cols[here] - block.rows.start
        own, n = col >= 0, block.rows.stop - block.rows.start
        places[here[own]] = block.diagonal.start + row[own] * n + col[own]
        before = cols[here[~own]] - (blocks[k - 1].rows.start if k else 0)
        column = np.searchsorted(block.used, before)
        places[here[~own]] = block.coupling.start + row[~own] * len(block.used) + column
    return places


def _columns(x: np.ndarray) -> np.ndarray:
    """Largest absolute entry of each column, positive."""
    return np.max(np.abs(x), axis=0, initial=float(np.finfo(float).tiny))
