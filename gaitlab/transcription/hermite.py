r"""Cubic Hermite collocation of second-order systems at two Gauss points per interval.

Positions and velocities at the nodes are the unknowns; between nodes q is the cubic that they define. With
:math:`s = t / h`,

.. math:: q(s) = h_{00} q_0 + h h_{10} v_0 + h_{01} q_1 + h h_{11} v_1,

velocities and accelerations are its derivatives, and the dynamics hold at the Gauss points
:math:`s = 1/2 \mp \sqrt{3}/6`, which integrate the criteria to fourth order (Hairer, Norsett, Wanner, Solving
Ordinary Differential Equations I, 1993, sec. II.7).
"""

import numpy as np

GAUSS_POINTS = np.array([0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0])


def hermite_coefficients(s: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Coefficients of (q0, v0, q1, v1) in (q, v, a) at fractions s of intervals of length h.

    Args:
        s: Fractions of the interval, shape (n_s,).
        h: Lengths of the intervals [s], shape (N,).

    Returns:
        Shape (N, n_s, 3, 4); units 1, s, 1/s and 1/s^2 as the row and column demand.
    """
    one = np.ones_like(s)
    basis = np.array(
        [
            [1 - 3 * s**2 + 2 * s**3, s - 2 * s**2 + s**3, 3 * s**2 - 2 * s**3, s**3 - s**2],
            [6 * s**2 - 6 * s, 1 - 4 * s + 3 * s**2, 6 * s - 6 * s**2, 3 * s**2 - 2 * s],
            [12 * s - 6 * one, 6 * s - 4 * one, 6 * one - 12 * s, 6 * s - 2 * one],
        ]
    )  # (3, 4, n_s)
    powers = np.array([[0, 1, 0, 1], [-1, 0, -1, 0], [-2, -1, -2, -1]])  # of h
    return np.moveaxis(basis, 2, 0)[None] * h[:, None, None, None] ** powers
