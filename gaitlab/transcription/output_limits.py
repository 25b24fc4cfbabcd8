r"""Limits of outputs, for instance of joint torques: inequalities at the Gauss points of a mechanical problem.

.. math:: \sigma_i y_i(q, v, a, f; p) \le b_i

with signs :math:`\sigma_i = \pm 1`, in units of |b_i| or one, whichever is larger, so that slacks are of order one.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..nlp.sparse_problem import Derivatives, Pattern, SparseStructure, Values
from .mechanical_problem import MechanicalProblem, MechanicalStructure


@dataclass(frozen=True, kw_only=True)
class OutputLimit:
    """One output that must not exceed a bound in one direction."""

    output: int
    """Index into the outputs y."""
    sign: float
    """1: y <= bound; -1: -y <= bound."""


@dataclass(frozen=True, eq=False)
class LimitedStructure:
    """Sparsity of a mechanical problem with limits; shared by all data and bounds."""

    plain: MechanicalStructure
    limits: tuple[OutputLimit, ...]

    @cached_property
    def sparse(self) -> SparseStructure:
        """Patterns: those of the plain problem, then one row per Gauss point and limit."""
        plain = self.plain.sparse
        kept = self.kept
        rows = np.broadcast_to(np.arange(kept.size // kept.shape[2]).reshape(kept.shape[:2])[:, :, None], kept.shape)
        columns = np.broadcast_to(self.plain.point_index[:, None, :], kept.shape)
        local = self.plain.hessian_kept
        z, shape = self.plain.point_index, local.shape
        hess_rows, hess_cols = np.broadcast_to(z[:, :, None], shape), np.broadcast_to(z[:, None, :], shape)
        return replace(
            plain,
            n_c=plain.n_c + kept.shape[0] * kept.shape[1],
            jac_c=Pattern(
                np.concatenate([plain.jac_c.rows, plain.n_c + rows[kept]]),
                np.concatenate([plain.jac_c.cols, columns[kept]]),
            ),
            hess=Pattern(
                np.concatenate([plain.hess.rows, hess_rows[local]]), np.concatenate([plain.hess.cols, hess_cols[local]])
            ),
        )

    @cached_property
    def kept(self) -> np.ndarray:
        """Which entries of the rows belong to unknowns, shape (2 N, n_limits, n_z)."""
        used = self.plain.point_index >= 0
        return np.broadcast_to(used[:, None, :], (len(used), len(self.limits), used.shape[1]))


@dataclass(frozen=True)
class LimitedProblem:
    """A `SparseProblem`: a mechanical problem and bounds of some of its outputs."""

    inner: MechanicalProblem
    shared: LimitedStructure
    bounds: np.ndarray
    """Largest values of sign times output, shape (n_limits,)."""

    @property
    def structure(self) -> SparseStructure:
        """Sizes and sparsity."""
        return self.shared.sparse

    @property
    def _outputs(self) -> np.ndarray:
        return np.array([limit.output for limit in self.shared.limits])

    @property
    def _factors(self) -> np.ndarray:
        signs = np.array([limit.sign for limit in self.shared.limits])
        return signs / np.maximum(np.abs(self.bounds), 1.0)

    def values(self, w: np.ndarray) -> Values:
        """Objective and constraints at w, shape (n_w,)."""
        plain = self.inner.values(w)
        limits = self.bounds / np.maximum(np.abs(self.bounds), 1.0)
        slack = limits - self._factors * self.inner.outputs(w)[:, self._outputs]  # (2 N, n_limits)
        return plain._replace(c=np.concatenate([plain.c, slack.ravel()]))

    def derivatives(self, w: np.ndarray, lam_g: np.ndarray, lam_c: np.ndarray) -> Derivatives:
        """First and second derivatives at w, shape (n_w,), multipliers (n_g,) and (n_c,)."""
        n_c, evaluate = self.inner.structure.n_c, self.inner.shared.evaluate
        plain = self.inner.derivatives(w, lam_g, lam_c[:n_c])
        z, p = self.inner.points(w), self.inner.data.p
        jacobian = evaluate["output_jacobian"](z, p)[0][:, :, self._outputs]  # (2 N, n_point, n_limits)
        rows = -np.swapaxes(self.inner.to_local(jacobian * self._factors), 1, 2)
        mu = np.zeros((len(z), evaluate["outputs"].function.numel_out(0)))
        pressed = lam_c[n_c:].reshape(len(z), -1) * self._factors
        for column, output in enumerate(self._outputs):  # two limits of one output add up
            mu[:, output] += pressed[:, column]
        point_hess = evaluate["output_hessian"](z, p, mu)[0]
        hess = self.inner.to_local(np.swapaxes(self.inner.to_local(point_hess), 1, 2))
        return plain._replace(
            jac_c=np.concatenate([plain.jac_c, rows[self.shared.kept]]),
            hess=np.concatenate([plain.hess, hess[self.inner.shared.hessian_kept]]),
        )
