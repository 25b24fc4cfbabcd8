"""Directions that leave constraints alone."""

import numpy as np
from scipy.optimize import nnls

RANK_TOLERANCE = 1e-8
"""Singular values below this share of the largest count as zero: their rows repeat others."""


def null_space_projection(rows: np.ndarray, direction: np.ndarray) -> np.ndarray:
    r"""Part of a direction, shape (n,), that does not change constraints with these gradients, shape (m, n).

    :math:`(I - J^T (J J^T)^{-1} J) d`, (5) of the source, with an orthonormal basis of the rows instead of the inverse,
    which repeated or vanishing rows do not have.
    """
    if not len(rows):
        return direction
    _, strengths, basis = np.linalg.svd(rows, full_matrices=False)
    basis = basis[strengths > RANK_TOLERANCE * max(strengths[0], np.finfo(float).tiny)]
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
    n_ec, columns = len(equality_rows), np.vstack([equality_rows, -equality_rows, inequality_rows])
    if not len(columns):
        return -gradient, np.zeros(0), np.zeros(0)
    lengths = np.linalg.norm(columns, axis=1)
    scaled = columns / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    try:
        dual = nnls(scaled.T, -gradient, maxiter=50 * len(columns))[0] / np.where(lengths > 0.0, lengths, 1.0)
    except RuntimeError:  # It cycles on repeated rows: hold all of them.
        return -null_space_projection(columns, gradient), np.zeros(n_ec), np.zeros(len(inequality_rows))
    lam, mu = dual[:n_ec] - dual[n_ec : 2 * n_ec], dual[2 * n_ec :]
    return -(gradient + equality_rows.T @ lam + inequality_rows.T @ mu), lam, mu
