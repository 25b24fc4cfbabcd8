"""Sparse linear algebra of path following: bordered matrices, their determinants and null vectors."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu


def stacked(blocks: Sequence[Sequence[Any]]) -> sparse.csc_matrix:
    """A matrix made of blocks; None stands for zeros."""
    return sparse.csc_matrix(sparse.bmat(blocks))


def factorised(matrix: sparse.csc_matrix) -> SuperLU | None:
    """LU factors of a square matrix, or None where it is singular to working precision."""
    try:
        return splu(matrix)
    except RuntimeError:  # "Factor is exactly singular"
        return None


def bordered(jacobian: sparse.csr_matrix, row: np.ndarray) -> sparse.csc_matrix:
    """The Jacobian, shape (n - 1, n), with one more row, shape (n,)."""
    # Appended by hand: stacking through scipy costs more than factorising a small matrix.
    n = len(row)
    data = np.concatenate([jacobian.data, row])
    indices = np.concatenate([jacobian.indices, np.arange(n, dtype=jacobian.indices.dtype)])
    start = np.append(jacobian.indptr, jacobian.indptr[-1] + n)
    return sparse.csc_matrix(sparse.csr_matrix((data, indices, start), shape=(n, n)))


def solve(matrix: sparse.csc_matrix, rhs: np.ndarray) -> np.ndarray | None:
    """Solution for a right-hand side of shape (n,), or None where there is no finite one."""
    factors = factorised(matrix)
    if factors is None:
        return None
    solution = factors.solve(rhs)
    return solution if np.all(np.isfinite(solution)) else None


def least_norm_step(jacobian: sparse.csr_matrix, residual: np.ndarray) -> np.ndarray | None:
    """Shortest solution d of J d = -r, J of shape (n - 1, n) and r (n - 1,); None where J has no full rank."""
    n = len(residual) + 1
    matrix = stacked([[sparse.identity(n), jacobian.T], [jacobian, None]])
    solution = solve(matrix, np.concatenate([np.zeros(n), -residual]))
    return None if solution is None else solution[:n]


def determinant_sign(matrix: sparse.csc_matrix) -> int:
    """Sign of the determinant; 0 where the matrix is singular to working precision."""
    factors = factorised(matrix)
    if factors is None:
        return 0
    negative = int(np.sum(factors.U.diagonal() < 0.0))
    return (-1) ** negative * _parity(factors.perm_r) * _parity(factors.perm_c)


def _parity(permutation: np.ndarray) -> int:
    """+1 for an even, -1 for an odd permutation, from the number of its cycles."""
    seen = np.zeros(len(permutation), dtype=bool)
    cycles = 0
    for first in range(len(permutation)):
        cycles += not seen[first]
        i = first
        while not seen[i]:
            seen[i] = True
            i = int(permutation[i])
    return (-1) ** ((len(permutation) - cycles) % 2)


@dataclass(frozen=True, kw_only=True)
class NullPair:
    """Unit vectors that a nearly singular matrix maps to almost nothing, from the right and from the left."""

    right: np.ndarray
    """From the right, shape (n,)."""
    left: np.ndarray
    """From the left, shape (n,)."""


def null_pair(matrix: sparse.csc_matrix) -> NullPair | None:
    """Singular vectors of the smallest singular value by inverse iteration; None without a factorisation."""
    generator = np.random.default_rng(0)
    n = len(matrix.indptr) - 1
    right, left = generator.normal(size=n), generator.normal(size=n)
    factors = factorised(matrix)
    if factors is None:
        # Singular to the last bit: a perturbation at rounding level has the same null vectors.
        scale = float(np.max(np.abs(matrix.data))) * 1e-12
        factors = factorised(sparse.csc_matrix(matrix + scale * sparse.identity(n)))
    if factors is None:
        return None
    for _ in range(6):
        left = factors.solve(right / np.linalg.norm(right), trans="T")
        right = factors.solve(left / np.linalg.norm(left))
    if not (np.all(np.isfinite(left)) and np.all(np.isfinite(right))):
        return None
    return NullPair(right=right / np.linalg.norm(right), left=left / np.linalg.norm(left))


def singularity(matrix: sparse.csc_matrix, pair: NullPair) -> float | None:
    """det(B) / det([[B, left], [right', 0]]), up to a factor that does not vanish near the pair's matrix.

    Smooth along a path and zero where B is singular (Govaerts, Numerical Methods for Bifurcations of Dynamical
    Equilibria, SIAM 2000, ch. 3): the last unknown of the bordered system with right-hand side (0, 1).
    """
    column, row = sparse.csr_matrix(pair.left[:, None]), sparse.csr_matrix(pair.right[None])
    solution = solve(stacked([[matrix, column], [row, None]]), np.append(np.zeros(len(pair.left)), 1.0))
    return None if solution is None else float(solution[-1])
