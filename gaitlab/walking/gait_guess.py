"""First guess of a gait whose states are given at the ends of its stages, from noisy measurements.

Curves of few coefficients that start and end in the given states, as near to the measurements as points that stand let
them be: from a guess whose feet slip, restoring the contacts throws the joints about.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ..nlp.codegen import Batch

PLACE, SPEED = 1e-3, 1e-2
"""Slips of a standing point [m, m/s] that count as much as one standard deviation of a measured coordinate."""
ROUNDS = 6
"""Gauss-Newton steps: both models of the thesis are then left with slips of 0.02 to 0.2 mm."""


@dataclass(frozen=True, kw_only=True)
class Curves:
    """q(s) = cubic through the given states + s^2 (1 - s)^2 times a polynomial, s = t / duration."""

    ends: np.ndarray
    """States at both ends [m, rad, 1/s], shape (2, 2 n_q)."""
    duration: float
    """[s]"""
    n: int
    """Number of intervals."""

    @cached_property
    def _tables(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        polynomial, s = np.polynomial.Polynomial, np.linspace(0.0, 1.0, self.n + 1)
        cubics = [polynomial(c) for c in ([1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1])]
        bubbles = [polynomial([0, 0, 1, -2, 1]) * polynomial.basis(i) for i in range(min(6, max(2, self.n // 4)))]
        (q0, v0), (q1, v1) = self.ends.reshape(2, 2, -1)
        known = np.stack([q0, self.duration * v0, q1, self.duration * v1])
        fixed = [np.stack([c.deriv(order)(s) for c in cubics], axis=1) @ known for order in (0, 1)]
        table, triangle = np.linalg.qr(np.stack([b(s) for b in bubbles], axis=1))
        rates = np.linalg.solve(triangle.T, np.stack([b.deriv()(s) for b in bubbles])).T
        return fixed[0], fixed[1] / self.duration, table, rates / self.duration

    @property
    def table(self) -> np.ndarray:
        """Derivative of a coordinate in its coefficients, shape (n + 1, m)."""
        return self._tables[2]

    @property
    def rates(self) -> np.ndarray:
        """Derivative of its rate in them [1/s], shape (n + 1, m)."""
        return self._tables[3]

    def states(self, coefficients: np.ndarray) -> np.ndarray:
        """States at the nodes for coefficients (m, n_q), shape (n + 1, 2 n_q)."""
        q, v, table, rates = self._tables
        return np.hstack([q + table @ coefficients, v + rates @ coefficients])


@dataclass(frozen=True, kw_only=True)
class StandingPoints:
    """Contact coordinates that stay as they are at the start of a stage."""

    functions: Mapping[str, ca.Function]
    """node_values and node_derivatives of the model."""
    p: np.ndarray
    """Parameters of the body, shape (n_p,)."""
    active: tuple[int, ...]
    """Contact coordinates that stand."""

    def slips(self, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Slips over what counts as one, (n, m), and Jacobian (n, m, 2 n_q), at states (n, 2 n_q), the first given."""
        values, derivatives = (Batch(self.functions[name], len(states)) for name in ("node_values", "node_derivatives"))
        y = values(states, self.p)[0]
        n_f, active = y.shape[1] // 2, list(self.active)
        slopes = np.swapaxes(derivatives(states, self.p, np.zeros_like(y))[0], 1, 2)
        y[:, :n_f] -= y[0, :n_f].copy()
        rows = active + [n_f + i for i in active]
        scale = np.repeat([PLACE, SPEED], len(active))
        return y[:, rows] / scale, slopes[:, rows] / scale[:, None]


def smooth_states(curves: Curves, q: np.ndarray, deviation: np.ndarray, standing: StandingPoints) -> np.ndarray:
    """States at the nodes, shape (n + 1, 2 n_q), near measured coordinates (n + 1, n_q) of given deviations (n_q,)."""
    n_q, table = q.shape[1], curves.table[1:-1]
    start = curves.states(np.zeros((table.shape[1], n_q)))[1:-1, :n_q]
    coefficients = np.linalg.lstsq(table, q[1:-1] - start, rcond=None)[0]
    near = np.kron(table, np.diag(1.0 / deviation))
    for _ in range(ROUNDS):
        states = curves.states(coefficients)
        slips, slopes = standing.slips(states)
        by_curve = np.einsum("tm,tij->timj", curves.table, slopes[:, :, :n_q])
        by_curve += np.einsum("tm,tij->timj", curves.rates, slopes[:, :, n_q:])
        rows = np.vstack([by_curve.reshape(slips.size, -1), near])
        residual = np.concatenate([slips.ravel(), ((states[1:-1, :n_q] - q[1:-1]) / deviation).ravel()])
        coefficients -= np.linalg.lstsq(rows, residual, rcond=None)[0].reshape(coefficients.shape)
    return curves.states(coefficients)
