"""Directions that leave constraints alone."""

import numpy as np
from scipy.optimize import nnls

RANK_TOLERANCE = 1e-4
"""Singular values below this share of the largest count as zero: their rows repeat others. Differences of rows that
repeat each other grow with the distance from where the constraints hold, which first-order steps leave at 1e-5."""


def null_space_projection(rows: np.ndarray, direction: np.ndarray) -> np.ndarray:
    r"""Part of a direction, shape (n,), that does not change constraints with these gradients, shape (m, n).

    :math:`(I - J^T (J J^T)^{-1} J) d`, (5) of the source, with an orthonormal basis of the rows instead of the inverse,
    which repeated or vanishing rows do not have.
    """
    basis, _, _ = _row_space(rows)
    return direction - basis.T @ (basis @ direction)


def allowed_descent(
    gradient: np.ndarray, equality_rows: np.ndarray, inequality_rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    r"""Steepest descent that active constraints allow, and their multipliers.

    The projection of :math:`-\nabla f` on the cone :math:`J_{eq} d = 0, J_{in} d \le 0`. It is (5) with the equalities
    and those inequalities that would be violated otherwise; which ones, Algorithm 3 of the source decides for each
    alone (lines 7 to 13), here nonnegative least squares do for all together (Lawson and Hanson 1974, ch. 23), so the
    direction vanishes exactly where the first-order conditions hold.

    Args:
        gradient: of the cost, shape (n,).
        equality_rows: gradients of the equalities, shape (n_ec, n).
        inequality_rows: gradients of the active inequalities, shape (n_a, n).

    Returns:
        Direction (n,), multipliers of the equalities (n_ec,), of the active inequalities (n_a,).
    """
    basis, strengths, left = _row_space(equality_rows)
    remaining = -gradient + basis.T @ (basis @ gradient)
    rows = inequality_rows - (inequality_rows @ basis.T) @ basis
    lengths = np.linalg.norm(rows, axis=1)
    # Rows that the equalities imply, but for rounding errors, would point anywhere.
    meant = lengths > RANK_TOLERANCE * np.maximum(np.linalg.norm(inequality_rows, axis=1), np.finfo(float).tiny)
    mu = np.zeros(len(rows))
    if meant.any():
        mu[meant] = nnls((rows[meant] / lengths[meant, None]).T, remaining, maxiter=100 * len(rows))[0] / lengths[meant]
    lam = -left @ ((basis @ (gradient + inequality_rows.T @ mu)) / strengths)
    return remaining - rows.T @ mu, lam, mu


def _row_space(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Orthonormal basis of the rows, shape (r, n), singular values (r,) and left vectors (m, r)."""
    if not len(rows):
        return rows, np.zeros(0), np.zeros((0, 0))
    left, strengths, basis = np.linalg.svd(rows, full_matrices=False)
    kept = strengths > RANK_TOLERANCE * max(strengths[0], np.finfo(float).tiny)
    return basis[kept], strengths[kept], left[:, kept]
