r"""Certificates of MPCC points: violation, complementarity and stationarity, computed apart from any solver.

A feasible point is B-stationary when no direction that is feasible to first order decreases the objective (Scheel and
Scholtes 2000; Hatz 2014, Definition 2.3.2), and strongly stationary when that even holds with both halves of each
biactive pair free to grow (Definition 2.3.3). A linear program in the direction d decides the second, and the same
program with one binary for each biactive pair, for which half stays zero, decides the first:

.. math:: \min_d \nabla f^T d \quad \text{s.t. linearised active constraints}, \; |d|_\infty \le 1,

whose optimal value is minus the smallest l1-norm of the Lagrangian's gradient over all admissible multipliers.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, cast

import casadi as ca
import numpy as np
from scipy.optimize import milp
from scipy.sparse import csr_matrix, diags, hstack, vstack

from .mpcc import MPCC

ACTIVE = 1e-6
"""A constraint nearer to its bound than this is active."""
MOST_SECONDS = 10.0
"""Time for deciding which halves of the biactive pairs may grow [s]."""


class Stationarity(StrEnum):
    """What first-order theory says of a feasible point."""

    STRONG = "strongly stationary"
    BOULIGAND = "B-stationary"
    DESCENT = "not stationary: a feasible direction decreases the objective"
    UNDECIDED = "undecided: too many biactive pairs for the time"
    INFEASIBLE = "not feasible"


@dataclass(frozen=True, kw_only=True)
class MPCCValues:
    """Functions and derivatives at one point."""

    f: float
    g: np.ndarray
    """Constraints, shape (n_g,)."""
    G: np.ndarray
    """First halves, shape (n_c,)."""
    H: np.ndarray
    """Second halves, shape (n_c,)."""


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """Stationarity of a point, with the way down where there is one."""

    stationarity: Stationarity
    slope: float
    """Directional derivative of f along the best direction found, at most 0."""
    first_half: np.ndarray
    """Which halves are held at zero along that direction: True for G, shape (n_c,)."""


class MPCCConditions:
    """Feasibility and stationarity of one MPCC at any number of points."""

    def __init__(self, problem: MPCC) -> None:
        self.problem = problem
        inputs, c = [problem.w, problem.p], [problem.f, problem.g, problem.G, problem.H]
        self._values = ca.Function("values", inputs, c)
        gradients = [ca.gradient(problem.f, problem.w)] + [ca.jacobian(part, problem.w) for part in c[1:]]
        self._gradients = ca.Function("gradients", inputs, gradients)

    def values(self, w: np.ndarray, p: np.ndarray) -> MPCCValues:
        """Functions at w, shape (n_w,), for parameters p, shape (n_p,)."""
        f, g, first, second = (np.asarray(out).ravel() for out in self._values(w, p))
        return MPCCValues(f=float(f[0]), g=g, G=first, H=second)

    def violation(self, w: np.ndarray, values: MPCCValues) -> float:
        """Largest violation of bounds, constraints and signs of the pairs at w, shape (n_w,)."""
        m = self.problem
        parts = [m.lbw - w, w - m.ubw, m.lbg - values.g, values.g - m.ubg, -values.G, -values.H]
        return float(np.max(np.concatenate([*parts, np.zeros(1)])))

    @staticmethod
    def complementarity(values: MPCCValues) -> float:
        """max_i min(|G_i|, |H_i|)."""
        return float(np.max(np.minimum(np.abs(values.G), np.abs(values.H)), initial=0.0))

    def stationarity(self, w: np.ndarray, p: np.ndarray, tol: float) -> Verdict:
        """Decide stationarity at a feasible w, shape (n_w,), parameters p (n_p,), to the relative slope `tol`."""
        return _Directions(self.problem, w, self.values(w, p), self._derivatives(w, p)).verdict(tol)

    def _derivatives(self, w: np.ndarray, p: np.ndarray) -> "list[csr_matrix]":
        return [csr_matrix(out.sparse()) for out in self._gradients(w, p)]


class _Directions:
    """Linear programs over the directions that are feasible to first order."""

    def __init__(self, problem: MPCC, w: np.ndarray, values: MPCCValues, derivatives: "list[csr_matrix]") -> None:
        self._gradient = derivatives[0].toarray().ravel()
        jac_g, self._G, self._H = derivatives[1:]
        equal = problem.lbg == problem.ubg
        low = ~equal & (values.g - problem.lbg <= ACTIVE)
        high = ~equal & (problem.ubg - values.g <= ACTIVE)
        self._equal = _rows(jac_g, equal)
        self._inward = _stack(_rows(jac_g, low), -_rows(jac_g, high))
        self._lower = np.where(w - problem.lbw <= ACTIVE, 0.0, -1.0)
        self._upper = np.where(problem.ubw - w <= ACTIVE, 0.0, 1.0)
        self._first, self._second = values.G <= ACTIVE, values.H <= ACTIVE
        self._biactive = np.flatnonzero(self._first & self._second)

    def verdict(self, tol: float) -> Verdict:
        limit = -tol * (1.0 + float(np.abs(self._gradient).max(initial=0.0)))
        relaxed, _ = self._steepest(coupled=False)
        if relaxed >= limit:
            return Verdict(stationarity=Stationarity.STRONG, slope=relaxed, first_half=self._first)
        slope, choice = self._steepest(coupled=True)
        found = Stationarity.DESCENT if slope < limit else Stationarity.BOULIGAND
        if choice is None:
            return Verdict(stationarity=Stationarity.UNDECIDED, slope=relaxed, first_half=self._first)
        held = self._first.copy()
        held[self._biactive] = choice < 0.5
        return Verdict(stationarity=found, slope=slope, first_half=held)

    def _steepest(self, coupled: bool) -> tuple[float, np.ndarray | None]:
        """Best slope over (d, z), and z, shape (n_biactive,): where z is 0 G stays zero, where it is 1 H does.

        Without coupling both halves of a pair may grow.
        """
        n, n_z = self._gradient.size, self._biactive.size if coupled else 0
        first, second = self._G[self._biactive], self._H[self._biactive]
        only_first, only_second = self._first & ~self._second, self._second & ~self._first
        equal = _stack(self._equal, _rows(self._G, only_first), _rows(self._H, only_second))
        inward = _stack(self._inward, first, second)
        rows: list[Any] = [(_wide(equal, n_z), 0.0, 0.0), (_wide(inward, n_z), 0.0, np.inf)]
        if n_z:
            # |d| <= 1 bounds what a half can grow by.
            most = [np.asarray(abs(half).sum(axis=1)).ravel() for half in (first, second)]
            rows.append((csr_matrix(hstack([first, -diags(most[0])])), -np.inf, 0.0))
            rows.append((csr_matrix(hstack([second, diags(most[1])])), -np.inf, most[1]))
        found = milp(
            np.concatenate([self._gradient, np.zeros(n_z)]),
            integrality=np.concatenate([np.zeros(n), np.ones(n_z)]),
            bounds=(np.append(self._lower, np.zeros(n_z)), np.append(self._upper, np.ones(n_z))),
            constraints=rows,
            options={"time_limit": MOST_SECONDS},
        )
        # d = 0 is always feasible: a program without a solution is a failure of its solver.
        return (float(found.fun), np.asarray(found.x)[n:]) if found.status == 0 else (float("-inf"), None)


def _wide(matrix: csr_matrix, n_z: int) -> csr_matrix:
    n_rows, _ = cast(tuple[int, int], matrix.shape)
    return csr_matrix(hstack([matrix, csr_matrix((n_rows, n_z))]))


def _rows(matrix: csr_matrix, chosen: np.ndarray) -> csr_matrix:
    pick = np.flatnonzero(chosen)
    size = (pick.size, chosen.size)
    return csr_matrix(csr_matrix((np.ones(pick.size), (np.arange(pick.size), pick)), shape=size) @ matrix)


def _stack(*blocks: csr_matrix) -> csr_matrix:
    return csr_matrix(vstack(blocks))
