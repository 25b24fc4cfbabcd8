"""Cubic Hermite collocation of a mechanical problem as a sparse program with exact derivatives per interval."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ..nlp.codegen import Batch
from ..nlp.sparse_problem import Derivatives, Pattern, SparseStructure, Values
from .hermite import GAUSS_POINTS, hermite_coefficients
from .mechanical_layout import ContactRow, MechanicalLayout


@dataclass(frozen=True, kw_only=True)
class MechanicalData:
    """Everything that may change from solve to solve without a new structure."""

    p: np.ndarray
    """Parameters of the system, shape (n_p,)."""
    theta: np.ndarray
    """Weights of the criteria, shape (n_criteria,)."""
    reference: np.ndarray
    """States to track, shape (N + 1, 2 n_q)."""
    tracking: np.ndarray
    """Weights of the squared tracking errors, shape (N + 1, 2 n_q); zero: no tracking."""
    given: np.ndarray
    """Given states; only the entries that the boundary names count, shape (N + 1, 2 n_q)."""
    lower: np.ndarray
    """Lower limits of the coordinates, used where the layout says so, shape (n_q,)."""
    upper: np.ndarray
    """Upper limits of the coordinates, shape (n_q,)."""
    acceleration_weights: np.ndarray
    """Weights of the squared accelerations, 1/2 int sum_i alpha_i a_i^2 dt, shape (n_q,)."""
    force_weight: float = 0.0
    """Weight of the squared scaled forces, which makes redundant contact forces unique."""
    allowance: float = 0.0
    """Depth [m] to which free points may sink."""


class MechanicalStructure:
    """Sparsity and functions of a layout, shared by all data."""

    def __init__(self, layout: MechanicalLayout, functions: Mapping[str, ca.Function]) -> None:
        self.layout, self.functions, n = layout, functions, layout.n_intervals
        self.coefficients = hermite_coefficients(GAUSS_POINTS, layout.interval_lengths()).reshape(2 * n, 3, 4)
        self.weights = np.repeat(layout.interval_lengths() / 2.0, 2)  # (2 N,)
        self.point_index = layout.point_index().reshape(2 * n, -1)
        self.force_index = layout.force_index().reshape(2 * n, -1)
        self.data = np.array([layout.stages[i].data for i in np.repeat(layout.stage_of_interval(), 2)])
        self.evaluate = {
            name: Batch(function, n + 1 if name.startswith("node") else 2 * n) for name, function in functions.items()
        }
        self.contact = layout.contact_equalities()
        self.clear = layout.clearances()
        self.cone = layout.cone_rows()
        self.limits = layout.limit_columns()
        self.n_w = 2 * layout.n_q * (n + 1) + int((self.force_index >= 0).sum())
        self.n_cone = 2 * sum(s.n_intervals * len(s.force_cone) for s in layout.stages)

    @cached_property
    def sparse(self) -> SparseStructure:
        """Patterns in the order in which `MechanicalProblem.derivatives` gives the entries."""
        n_residual, keys = 2 * self.layout.n_intervals * self.layout.n_r, self._time_keys()
        fixed = [*self.fixed_columns]
        contact_rows, contact_cols = self.contact_pattern(self.contact)
        n_contact = len(self.contact)
        residual_rows = np.repeat(np.arange(n_residual), self.point_index.shape[1]).reshape(self.residual_shape)
        residual_cols = np.repeat(self.point_index[:, None, :], self.layout.n_r, axis=1)
        kept = residual_cols >= 0
        fixed_rows = n_residual + n_contact + np.arange(len(fixed))
        first_limit = self.n_cone + len(self.clear)
        clear_rows, clear_cols = self.contact_pattern(self.clear)
        return SparseStructure(
            n_w=self.n_w,
            n_g=n_residual + n_contact + len(fixed),
            n_c=self.n_cone + len(self.clear) + 2 * len(self.limits),
            jac_g=Pattern(
                np.concatenate([residual_rows[kept], n_residual + contact_rows, fixed_rows]),
                np.concatenate([residual_cols[kept], contact_cols, np.array(fixed, dtype=np.int64)]),
            ),
            jac_c=Pattern(
                np.concatenate([self.cone[0], self.n_cone + clear_rows, first_limit + np.arange(2 * len(self.limits))]),
                np.concatenate([self.cone[1], clear_cols, self.limits, self.limits]),
            ),
            hess=self._hessian_pattern(),
            order=np.argsort(keys, kind="stable"),
            # A block holds a node and the interval before it.
            blocks=np.bincount(np.ceil(keys - 0.2).astype(np.int64)),
        )

    @property
    def residual_shape(self) -> tuple[int, int, int]:
        """Shape of all residual Jacobians in the local unknowns, (2 N, n_r, 4 n_q + n_f)."""
        return (2 * self.layout.n_intervals, self.layout.n_r, self.point_index.shape[1])

    @cached_property
    def fixed_columns(self) -> np.ndarray:
        """Indices in w of the given entries of states, shape (n_fixed,)."""
        width = 2 * self.layout.n_q
        given = self.layout.boundary.given
        return np.array([width * node + i for node, entries in given for i in entries], dtype=np.int64)

    def contact_pattern(self, rows: list[ContactRow]) -> tuple[np.ndarray, np.ndarray]:
        """Row and column of the entries of contact rows: 2 n_q per node that takes part, each of shape (nnz,)."""
        width = 2 * self.layout.n_q
        row, node = self.contact_nodes(rows)[:2]
        return np.repeat(row, width), (node[:, None] * width + np.arange(width)).ravel()

    def contact_nodes(self, rows: list[ContactRow]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Rows as terms (row, node, component, sign), each of shape (n_terms,): the difference of two nodes is two."""
        table = [(i, r.node, r.component, 1.0) for i, r in enumerate(rows)]
        table += [(i, r.minus_node, r.component, -1.0) for i, r in enumerate(rows) if r.minus_node >= 0]
        columns = np.array(table, dtype=float).reshape(-1, 4)
        row, node, component = (columns[:, i].astype(np.int64) for i in range(3))
        return row, node, component, columns[:, 3]

    @cached_property
    def contact_terms(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Terms (row, node, component, sign) of the contact equalities, each of shape (n_terms,)."""
        return self.contact_nodes(self.contact)

    @cached_property
    def clear_terms(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Terms (row, node, component, sign) of the clearances, each of shape (n_terms,)."""
        return self.contact_nodes(self.clear)

    @cached_property
    def hessian_kept(self) -> np.ndarray:
        """Which entries of the local Hessians belong to unknowns, shape (2 N, n_z, n_z)."""
        used = self.point_index >= 0
        return used[:, :, None] & used[:, None, :]

    @cached_property
    def hessian_places(self) -> np.ndarray:
        """Where those are among all of them, shape (n_kept,)."""
        return np.flatnonzero(self.hessian_kept)

    def _hessian_pattern(self) -> Pattern:
        z, width = self.point_index, 2 * self.layout.n_q
        shape = self.hessian_kept.shape
        rows = np.broadcast_to(z[:, :, None], shape)[self.hessian_kept]
        cols = np.broadcast_to(z[:, None, :], shape)[self.hessian_kept]
        x = np.arange(width * (self.layout.n_intervals + 1)).reshape(-1, width)
        node_shape = (len(x), width, width)
        node_rows = np.broadcast_to(x[:, :, None], node_shape).ravel()
        node_cols = np.broadcast_to(x[:, None, :], node_shape).ravel()
        diagonal = np.arange(self.n_w)
        return Pattern(np.concatenate([rows, node_rows, diagonal]), np.concatenate([cols, node_cols, diagonal]))

    def _time_keys(self) -> np.ndarray:
        n, layout = self.layout.n_intervals, self.layout
        states = np.repeat(np.arange(n + 1.0), 2 * layout.n_q)
        forces = np.repeat(np.arange(2 * n) // 2 + 0.5, (self.force_index >= 0).sum(axis=1))
        residuals = np.repeat(np.arange(2 * n) // 2 + 0.5, layout.n_r)
        contacts = [(r.node - 0.5 if r.minus_node >= 0 else r.node - 0.4) for r in self.contact]
        fixed = self.fixed_columns // (2 * layout.n_q) + 0.1
        return np.concatenate([states, forces, residuals, contacts, fixed])


@dataclass(frozen=True)
class MechanicalProblem:
    """A `SparseProblem`: structure and data."""

    shared: MechanicalStructure
    data: MechanicalData

    @property
    def structure(self) -> SparseStructure:
        """Sizes and sparsity."""
        return self.shared.sparse

    def states(self, w: np.ndarray) -> np.ndarray:
        """States at the nodes, shape (N + 1, 2 n_q)."""
        layout = self.shared.layout
        return w[: 2 * layout.n_q * (layout.n_intervals + 1)].reshape(-1, 2 * layout.n_q)

    def points(self, w: np.ndarray) -> np.ndarray:
        """(q, v, a, f) at all Gauss points, shape (2 N, 3 n_q + n_f)."""
        s, n_q = self.shared, self.shared.layout.n_q
        local = np.where(s.point_index >= 0, w[s.point_index], 0.0)
        x = local[:, : 4 * n_q].reshape(-1, 4, n_q)
        return np.concatenate([(s.coefficients @ x).reshape(-1, 3 * n_q), local[:, 4 * n_q :]], axis=1)

    def criteria(self, w: np.ndarray) -> np.ndarray:
        """Integrals of the criteria, shape (n_criteria,)."""
        return self.shared.weights @ self.running_criteria(w)

    def running_criteria(self, w: np.ndarray) -> np.ndarray:
        """Criteria at the Gauss points, shape (2 N, n_criteria)."""
        z = self.points(w)
        return self._criteria(z, self._outputs(z))

    def outputs(self, w: np.ndarray) -> np.ndarray:
        """Outputs at the Gauss points, shape (2 N, n_y)."""
        return self._outputs(self.points(w))

    def _outputs(self, z: np.ndarray) -> np.ndarray:
        return self.shared.evaluate["outputs"](z, self.data.p)[0]

    def _velocities(self, z: np.ndarray) -> np.ndarray:
        n_q = self.shared.layout.n_q
        return z[:, n_q : 2 * n_q]

    def _criteria(self, z: np.ndarray, y: np.ndarray) -> np.ndarray:
        return self.shared.evaluate["criteria"](y, self._velocities(z), self.data.p, self.shared.data)[0]

    def values(self, w: np.ndarray) -> Values:
        """Objective and constraints at w, shape (n_w,)."""
        s, d = self.shared, self.data
        z = self.points(w)
        y = self._outputs(z)
        criteria = self._criteria(z, y)
        contact = s.evaluate["node_values"](self.states(w), d.p)[0]
        error = self.states(w) - d.reference
        forces = z[:, 3 * s.layout.n_q :]
        f = s.weights @ (criteria @ d.theta) + 0.5 * np.sum(d.tracking * error**2)
        accelerations = z[:, 2 * s.layout.n_q : 3 * s.layout.n_q]
        f += 0.5 * s.weights @ (accelerations**2 @ d.acceleration_weights)
        f += 0.5 * d.force_weight * (s.weights @ np.sum(forces**2, axis=1))
        g = np.concatenate(
            [y[:, : s.layout.n_r].ravel(), self._rows(s.contact_terms, contact, len(s.contact)), self._fixed(w)]
        )
        cone = np.bincount(s.cone[0], weights=s.cone[2] * w[s.cone[1]], minlength=s.n_cone)
        clear = self._rows(s.clear_terms, contact, len(s.clear)) + d.allowance
        limited, q = s.limits % (2 * s.layout.n_q), w[s.limits]
        return Values(float(f), g, np.concatenate([cone, clear, q - d.lower[limited], d.upper[limited] - q]))

    def _rows(
        self, terms: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], contact: np.ndarray, n: int
    ) -> np.ndarray:
        row, node, component, sign = terms
        return np.bincount(row, weights=sign * contact[node, component], minlength=n)

    def _fixed(self, w: np.ndarray) -> np.ndarray:
        columns = self.shared.fixed_columns
        return w[columns] - self.data.given.ravel()[columns]

    def derivatives(self, w: np.ndarray, lam_g: np.ndarray, lam_c: np.ndarray) -> Derivatives:
        """First and second derivatives at w, shape (n_w,), multipliers (n_g,) and (n_c,)."""
        s, d = self.shared, self.data
        n_residual = 2 * s.layout.n_intervals * s.layout.n_r
        jac, grad, hess, first_term = self._point_derivatives(
            self.points(w), lam_g[:n_residual].reshape(s.residual_shape[:2])
        )
        mu = self._node_multipliers(
            lam_g[n_residual : n_residual + len(s.contact)], lam_c[s.n_cone : s.n_cone + len(s.clear)]
        )
        contact_jac, contact_hess = s.evaluate["node_derivatives"](self.states(w), d.p, mu)
        jac_r = np.swapaxes(self.to_local(jac), 1, 2)  # (2 N, n_r, n_z)
        kept, unit = np.broadcast_to((s.point_index >= 0)[:, None, :], jac_r.shape), np.ones(len(s.limits))
        jac_g = [jac_r[kept], self._contact_entries(s.contact_terms, contact_jac), np.ones(len(s.fixed_columns))]
        return Derivatives(
            grad=self._gradient(w, grad),
            jac_g=np.concatenate(jac_g),
            jac_c=np.concatenate([s.cone[2], self._contact_entries(s.clear_terms, contact_jac), unit, -unit]),
            hess=self._hessian_entries(hess, contact_hess),
            gauss_newton=lambda: self._hessian_entries(first_term, np.zeros_like(contact_hess)),
        )

    def _hessian_entries(self, points: np.ndarray, nodes: np.ndarray) -> np.ndarray:
        """Entries for Hessians in (q, v, a, f) at the Gauss points and in the states at the nodes."""
        local = self.to_local(np.swapaxes(self.to_local(points), 1, 2))
        return np.concatenate([local.ravel()[self.shared.hessian_places], nodes.ravel(), self._diagonal()])

    def _point_derivatives(
        self, z: np.ndarray, lam: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Transposed residual Jacobian, cost gradient, Hessian of the Lagrangian in (q, v, a, f) and its first term.

        With xi = (y, v) and the weighted cost phi(xi): gradient J' phi', Hessian J' phi'' J + sum_i phi'_i y_i''.
        """
        s, d = self.shared, self.data
        n_q, n_y = s.layout.n_q, s.evaluate["outputs"].function.numel_out(0)
        y, v = self._outputs(z), self._velocities(z)
        theta = s.weights[:, None] * d.theta
        slope, curvature = s.evaluate["criteria_derivatives"](y, v, d.p, s.data, theta)
        jac = np.zeros((len(z), z.shape[1], n_y + n_q))
        jac[:, :, :n_y] = s.evaluate["output_jacobian"](z, d.p)[0]
        jac[:, n_q : 2 * n_q, n_y:] = np.eye(n_q)
        mu = slope[:, :n_y].copy()
        mu[:, : s.layout.n_r] += lam
        # Most outputs and velocities are in no criterion.
        used = np.flatnonzero(np.any(curvature != 0.0, axis=(0, 1)))
        by_used = jac[:, :, used]
        first_term = by_used @ curvature[:, used][:, :, used] @ np.swapaxes(by_used, 1, 2)
        gradient = (jac @ slope[:, :, None])[:, :, 0]
        smooth = s.weights[:, None] * d.acceleration_weights
        gradient[:, 2 * n_q : 3 * n_q] += smooth * z[:, 2 * n_q : 3 * n_q]
        diagonal = np.arange(2 * n_q, 3 * n_q)
        first_term[:, diagonal, diagonal] += smooth
        hess = s.evaluate["output_hessian"](z, d.p, mu)[0] + first_term
        return jac[:, :, : s.layout.n_r], gradient, hess, first_term

    def criterion_gradients(self, w: np.ndarray) -> np.ndarray:
        """Gradients of the integrated criteria, shape (n_w, n_criteria)."""
        s, d, z = self.shared, self.data, self.points(w)
        n_q, n_y = s.layout.n_q, s.evaluate["outputs"].function.numel_out(0)
        y, v = self._outputs(z), self._velocities(z)
        inner = np.swapaxes(s.evaluate["criteria_jacobian"](y, v, d.p, s.data)[0], 1, 2)  # (2 N, n_c, n_y + n_q)
        gradient = s.evaluate["output_jacobian"](z, d.p)[0] @ np.swapaxes(inner[:, :, :n_y], 1, 2)
        gradient[:, n_q : 2 * n_q] += np.swapaxes(inner[:, :, n_y:], 1, 2)
        return self.scatter_gradient(s.weights[:, None, None] * gradient)

    def to_local(self, block: np.ndarray) -> np.ndarray:
        """Chain rule from (q, v, a, f), shape (2 N, 3 n_q + n_f, m), to (q0, v0, q1, v1, f), shape (2 N, n_z, m)."""
        s, n_q = self.shared, self.shared.layout.n_q
        n, m = len(block), block.shape[2]
        x = np.swapaxes(s.coefficients, 1, 2) @ block[:, : 3 * n_q].reshape(n, 3, n_q * m)
        return np.concatenate([x.reshape(n, 4 * n_q, m), block[:, 3 * n_q :]], axis=1)

    def scatter_gradient(self, point_gradient: np.ndarray) -> np.ndarray:
        """Sum gradients in (q, v, a, f) at the Gauss points, shape (2 N, 3 n_q + n_f, m), over w; (n_w, m)."""
        s = self.shared
        local = self.to_local(point_gradient)
        kept = s.point_index >= 0
        columns = [
            np.bincount(s.point_index[kept], weights=local[:, :, j][kept], minlength=s.n_w)
            for j in range(local.shape[2])
        ]
        return np.stack(columns, axis=1)

    def _gradient(self, w: np.ndarray, point_gradient: np.ndarray) -> np.ndarray:
        d = self.data
        gradient = self.scatter_gradient(point_gradient[:, :, None])[:, 0]
        n_x = d.tracking.size
        gradient[:n_x] += (d.tracking * (self.states(w) - d.reference)).ravel()
        gradient[n_x:] += self._diagonal()[n_x:] * w[n_x:]
        return gradient

    def _diagonal(self) -> np.ndarray:
        s, d = self.shared, self.data
        weights = np.broadcast_to(s.weights[:, None], s.force_index.shape)[s.force_index >= 0]
        return np.concatenate([d.tracking.ravel(), d.force_weight * weights])

    def _contact_entries(
        self, terms: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray], jacobian: np.ndarray
    ) -> np.ndarray:
        _, node, component, sign = terms
        # Batch returns column-major matrices: (nodes, 2 n_q, 2 n_f).
        return (sign[:, None] * jacobian[node, :, component]).ravel()

    def _node_multipliers(self, lam_contact: np.ndarray, lam_clear: np.ndarray) -> np.ndarray:
        layout = self.shared.layout
        mu = np.zeros((layout.n_intervals + 1, 2 * layout.n_f))
        for terms, lam in ((self.shared.contact_terms, lam_contact), (self.shared.clear_terms, -lam_clear)):
            row, node, component, sign = terms
            np.add.at(mu, (node, component), sign * lam[row])
        return mu
