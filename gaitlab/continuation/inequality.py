r"""Inequalities G(u) <= 0 with multipliers sigma, by relaxed complementarity.

.. math::

    -\sigma_j G_j(u) = \kappa \, \eta_1

At kappa = 0 these are the complementarity conditions: of a minimum where eta_1 = 1 is approached with kappa > 0, of a
maximum where eta_1 = -1 with kappa < 0, so that sigma > 0 in both cases.
(Li and Dankowicz, "Optimization with equality and inequality constraints using parameter continuation", Appl. Math.
Comput. 375, 2020, relax a complementarity function in the same place.) The factor eta_1, the multiplier of the
objective, keeps the equations homogeneous in the multipliers: the trivial branch survives, its folds are those of the
objective with a logarithmic barrier, and successive continuation runs as without inequalities. For kappa != 0 the path
passes smoothly from an inactive to an active inequality; driving kappa to zero comes last.
"""

from typing import NamedTuple

import numpy as np

from .staged_function import Entries


class Relaxation(NamedTuple):
    """What the complementarity equations see at one point."""

    g: np.ndarray
    """Inequalities, shape (n_c,)."""
    sigma: np.ndarray
    """Their multipliers, shape (n_c,)."""
    kappa: float
    d_objective: float
    """Multiplier eta_1 of the objective."""

    def residual(self) -> np.ndarray:
        """-sigma g - kappa eta_1, shape (n_c,)."""
        return -self.sigma * self.g - self.kappa * self.d_objective


class Positions(NamedTuple):
    """Where the unknowns of these equations stand among all."""

    row: int
    """First of the equations."""
    sigma: int
    """First multiplier of an inequality."""
    d_objective: int
    kappa: int


def complementarity_jacobian(point: Relaxation, at: Positions, jacobian: Entries) -> list[Entries]:
    """Derivative of `Relaxation.residual` in all unknowns; `jacobian` is that of g, shape (n_c, n_u)."""
    order = np.arange(len(point.g))
    ones = np.ones(len(point.g))
    return [
        Entries(at.row + jacobian.rows, jacobian.cols, -point.sigma[jacobian.rows] * jacobian.values),
        Entries(at.row + order, at.sigma + order, -point.g),
        Entries(at.row + order, np.full(len(order), at.d_objective), -point.kappa * ones),
        Entries(at.row + order, np.full(len(order), at.kappa), -point.d_objective * ones),
    ]
