"""Minimax problems: the largest of several functions is to be as small as possible.

How many functions there are may change from point to point, as the local maxima of an output over time do; only the
largest value is continuous.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import nnls

from .solution import KKTResiduals


class MinimaxPoint(Protocol):
    """What is known about one point; everything is evaluated on demand."""

    @property
    def values(self) -> np.ndarray:
        """Functions h_i, the largest of which counts, shape (n_i,)."""
        ...

    @property
    def is_peak(self) -> np.ndarray:
        """False for guards: functions that never exceed the others here but might after a step, shape (n_i,)."""
        ...

    @property
    def measure(self) -> np.ndarray:
        """Weights of the functions in a smooth form (quadrature of samples over time), sum one, shape (n_i,)."""
        ...

    @property
    def equality(self) -> np.ndarray:
        """Constraints phi = 0, shape (n_phi,)."""
        ...

    @property
    def gradients(self) -> np.ndarray:
        """Gradients of the functions, shape (n_i, n_w)."""
        ...

    @property
    def equality_jacobian(self) -> np.ndarray:
        """Jacobian of phi, shape (n_phi, n_w)."""
        ...

    def hessian(self, mu: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """Hessian of mu' values + lam' equality for shapes (n_i,), (n_phi,); result (n_w, n_w)."""
        ...


class MinimaxProblem(Protocol):
    r"""Constrained minimax problem.

    .. math::

        \underset{w}{\text{minimize}} \; \max_i h_i(w) \quad \text{subject to} \quad
        \phi(w) = 0, \; \underline{w} \le w \le \overline{w}
    """

    @property
    def lbw(self) -> np.ndarray:
        """Lower bounds, shape (n_w,)."""
        ...

    @property
    def ubw(self) -> np.ndarray:
        """Upper bounds, shape (n_w,)."""
        ...

    def evaluate(self, w: np.ndarray) -> MinimaxPoint:
        """Look at w, shape (n_w,)."""
        ...


class MinimaxStatus(StrEnum):
    """How a minimax solve ended; `MinimaxSolution.reason` says where it got stuck."""

    SOLVED = "solved"
    ITERATION_LIMIT = "iteration limit reached"
    STALLED = "stalled: no step improves the largest value or feasibility"
    INFEASIBLE = "the constraints cannot be met from here"
    UNBOUNDED = "unbounded"
    INVALID_NUMBER = "a function returned a number that is not finite"


@dataclass(frozen=True, kw_only=True)
class Multipliers:
    """Dual variables of a minimax problem at one point."""

    mu: np.ndarray
    """Multipliers of the functions, not negative, sum one, shape (n_i,)."""
    lam: np.ndarray
    """Multipliers of phi, shape (n_phi,)."""
    lam_w: np.ndarray
    """Multipliers of the bounds, shape (n_w,); negative where `lbw` is active."""


@dataclass(frozen=True, kw_only=True)
class MinimaxSolution:
    """Point with its certificate."""

    w: np.ndarray
    """Variables, shape (n_w,)."""
    value: float
    """Largest of the functions."""
    objective: float
    """What was minimised: `value`, or a smooth form of it."""
    peaks: np.ndarray
    """Functions without guards, shape (n_peaks,)."""
    equality: np.ndarray
    """phi, shape (n_phi,)."""
    multipliers: Multipliers = field(repr=False)
    residuals: KKTResiduals
    """Violation of the first-order conditions."""
    reduced_curvature: float
    """Smallest eigenvalue of the Lagrangian's Hessian in the directions that the active functions, constraints and
    bounds leave; infinite where they leave none, not a number where the solve failed."""
    status: MinimaxStatus
    reason: str
    """One sentence: why the method stopped."""
    iterations: int
    evaluations: int
    """Points looked at."""
    seconds: float

    @property
    def n_largest(self) -> int:
        """Number of peaks within 0.1 % of the largest."""
        return int(np.sum(self.peaks >= self.value - 1e-3 * abs(self.value)))

    def is_optimal(self, tol: float) -> bool:
        """Check the first-order conditions to the tolerance `tol`."""
        return self.residuals.max() < tol

    @property
    def is_minimum(self) -> bool:
        """Second-order sufficiency (Nocedal and Wright 2006, Theorem 12.6, for the epigraph form)."""
        return self.reduced_curvature > 0.0


def estimate_multipliers(problem: MinimaxProblem, w: np.ndarray, point: MinimaxPoint, near: float) -> Multipliers:
    """Multipliers that come nearest to stationarity at w, shape (n_w,), by nonnegative least squares.

    Peaks within the share `near` of the largest value and bounds that are touched may have some. Lawson and Hanson
    (1974), ch. 23; the sum of mu is held at one by a heavy row.
    """
    values, n_w = point.values, len(w)
    top = float(values.max())
    active = np.flatnonzero(point.is_peak & (values >= top - near * abs(top)))
    G, A = point.gradients[active], point.equality_jacobian
    touch = 1e-9 * (1.0 + np.abs(w))
    lower, upper = np.flatnonzero(w - problem.lbw <= touch), np.flatnonzero(problem.ubw - w <= touch)
    identity = np.eye(n_w)
    columns = np.hstack([G.T, A.T, -A.T, -identity[:, lower], identity[:, upper]])
    heavy = 1e3 * max(float(np.abs(G).max(initial=0.0)), 1e-12)
    sum_row = heavy * (np.arange(columns.shape[1]) < len(active))
    target = np.concatenate([np.zeros(n_w), [heavy]])
    dual = _nonnegative(np.vstack([columns, sum_row]), target)
    mu, lam, lam_w = np.zeros(len(values)), dual[len(active) :][: 2 * len(A)], np.zeros(n_w)
    mu[active] = dual[: len(active)]
    bounds = dual[len(active) + 2 * len(A) :]
    lam_w[lower] -= bounds[: len(lower)]
    lam_w[upper] += bounds[len(lower) :]
    total = mu.sum()
    if total <= 0.0:
        return Multipliers(mu=(values == top) / np.sum(values == top), lam=np.zeros(len(A)), lam_w=np.zeros(n_w))
    return Multipliers(mu=mu / total, lam=(lam[: len(A)] - lam[len(A) :]) / total, lam_w=lam_w / total)


def certify(problem: MinimaxProblem, w: np.ndarray, point: MinimaxPoint, dual: Multipliers) -> KKTResiduals:
    """First-order conditions at w, shape (n_w,): stationarity, feasibility, mu_i (largest - h_i)."""
    stationarity = dual.mu @ point.gradients + dual.lam @ point.equality_jacobian + dual.lam_w
    outside = np.maximum(np.maximum(problem.lbw - w, w - problem.ubw), 0.0)
    return KKTResiduals(
        stationarity=_norm(stationarity),
        primal=_norm(np.concatenate([point.equality, outside])),
        complementarity=_norm(dual.mu * (point.values.max() - point.values)),
    )


def reduced_curvature(point: MinimaxPoint, dual: Multipliers) -> float:
    """Smallest curvature of the Lagrangian where functions and bounds with multipliers, and phi, do not change."""
    n_w = len(dual.lam_w)
    rows = [point.gradients[dual.mu > 0.0], point.equality_jacobian, np.eye(n_w)[dual.lam_w != 0.0]]
    tangent = null_space(np.vstack(rows), rcond=1e-9)  # (n_w, n_free)
    if not tangent.shape[1]:
        return float("inf")
    return float(np.linalg.eigvalsh(tangent.T @ point.hessian(dual.mu, dual.lam) @ tangent)[0])


def _nonnegative(matrix: np.ndarray, target: np.ndarray) -> np.ndarray:
    try:
        return nnls(matrix, target, maxiter=30 * matrix.shape[1])[0]
    except RuntimeError:  # It cycles on degenerate columns: no estimate.
        return np.zeros(matrix.shape[1])


def _norm(v: np.ndarray) -> float:
    return float(np.max(np.abs(v), initial=0.0))
