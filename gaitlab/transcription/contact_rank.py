"""Contact conditions that follow from others.

Where postures are given, a planted foot between two of them is fixed from both ends, and a rigid foot whose heel and
toe are planted fixes components that are later held again. Such rows leave the solution as it is but make the KKT
matrix singular. Which rows they are depends only on which contacts meet which given postures, so they are found once,
numerically, at a posture that satisfies them all.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import cast

import casadi as ca
import numpy as np
from scipy.linalg import qr

from ..nlp.codegen import Batch
from .mechanical_layout import ContactRow, MechanicalLayout

RANK_TOLERANCE = 1e-7
"""Relative to the largest diagonal entry of R; contact Jacobians have entries of the order of one metre."""


def without_redundant_contacts(
    layout: MechanicalLayout, functions: Mapping[str, ca.Function], p: np.ndarray, states: np.ndarray
) -> MechanicalLayout:
    """Layout whose position conditions are independent at states, shape (N + 1, 2 n_q), parameters (n_p,)."""
    rows = [row for row in layout.contact_equalities() if row.component < layout.n_f]
    if not rows:
        return layout
    jacobian = _free_jacobian(layout, rows, Batch(functions["node_derivatives"], len(states)), (p, states))
    triangle, order = cast("tuple[np.ndarray, np.ndarray]", qr(jacobian.T, mode="r", pivoting=True))
    diagonal = np.abs(np.diag(triangle))
    rank = int(np.sum(diagonal > RANK_TOLERANCE * diagonal[0]))
    return replace(layout, redundant=layout.redundant | {rows[i] for i in order[rank:]})


def _free_jacobian(
    layout: MechanicalLayout, rows: list[ContactRow], derivatives: Batch, at: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Jacobian of position rows in the postures that are not given, shape (n_rows, n_free)."""
    p, states = at
    n_q = layout.n_q
    node_jacobian = derivatives(states, p, np.zeros((len(states), 2 * layout.n_f)))[0]  # (N + 1, 2 n_q, 2 n_f)
    full = np.zeros((len(rows), len(states), n_q))
    for i, row in enumerate(rows):
        full[i, row.node] += node_jacobian[row.node, :n_q, row.component]
        if row.minus_node >= 0:
            full[i, row.minus_node] -= node_jacobian[row.minus_node, :n_q, row.component]
    for node in range(len(states)):
        full[:, node, [i for i in layout.boundary.indices(node) if i < n_q]] = 0.0
    return full.reshape(len(rows), -1)
