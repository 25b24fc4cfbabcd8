"""Estimation of parameters of a nonlinear program from measurements of its solution."""

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..nlp.problem import NLP

_NO_CONSTRAINTS = np.zeros(0)


@dataclass(frozen=True, kw_only=True)
class InverseProblem:
    r"""Bilevel least squares: parameters whose lower-level solution is nearest to the measurements.

    .. math::

        \underset{p}{\text{minimize}} \; \tfrac{1}{2} |r(w^*(p), p)|^2 \quad \text{subject to} \quad
        \underline{p} \le p \le \overline{p}, \; \sum_{i \in S} p_i = 1, \;
        \underline{u} \le u(w^*(p), p) \le \overline{u}

    where :math:`w^*(p)` solves the lower level `nlp`, and entries of p that are not free keep their nominal value.
    Hatz (2014), (4.4)-(4.6).

    Raises:
        ProblemError: A shape is wrong, a bound is crossed or not a number, or the simplex cannot be met.
    """

    nlp: NLP
    """Lower level; its parameters p are (theta, model parameters)."""
    residual: ca.SX
    """(model - measurement) / standard deviation in (nlp.w, nlp.p), shape (n_m, 1)."""
    free: np.ndarray
    """Which entries of p are estimated, booleans, shape (n_p,)."""
    lbp: np.ndarray
    """Lower bounds of p, shape (n_p,); read for free entries only."""
    ubp: np.ndarray
    """Upper bounds of p, shape (n_p,); read for free entries only."""
    p_nominal: np.ndarray
    """Values of the entries that are not free, and the usual start of the others, shape (n_p,)."""
    simplex: tuple[int, ...] = ()
    """Indices of entries of p whose sum is one (criterion weights); at least one of them is free."""
    upper: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    """Upper-level constraint functions of (nlp.w, nlp.p), shape (n_u, 1)."""
    lbu: np.ndarray = field(default_factory=lambda: _NO_CONSTRAINTS)
    """Lower bounds on `upper`, shape (n_u,)."""
    ubu: np.ndarray = field(default_factory=lambda: _NO_CONSTRAINTS)
    """Upper bounds on `upper`, shape (n_u,)."""
    names: tuple[str, ...] = ()
    """Names of the entries of p for messages; p[0], p[1] ... when left empty."""

    def __post_init__(self) -> None:
        self._check_shapes()
        self._check_symbols()
        self._check_bounds()
        self._check_simplex()

    @property
    def n_p(self) -> int:
        """Number of parameters of the lower level."""
        return self.nlp.p.numel()

    @property
    def free_index(self) -> np.ndarray:
        """Places of the estimated entries in p, shape (n_free,)."""
        return np.flatnonzero(self.free)

    def parameter_name(self, index: int) -> str:
        """Name of p[index] for messages."""
        return self.names[index] if self.names else f"p[{index}]"

    def start(self, p0: np.ndarray) -> np.ndarray:
        """Nearest admissible parameters to p0: bounds, simplex and fixed entries hold; shapes (n_p,).

        Raises:
            ProblemError: p0 has another shape or an entry that is not a number.
        """
        if p0.shape != (self.n_p,):
            raise ProblemError(f"p0 must have shape ({self.n_p},), got {p0.shape}")
        self._check_finite("p0", p0)
        p = np.where(self.free, np.clip(p0, self.lbp, self.ubp), self.p_nominal)
        if self.simplex:
            chosen, total = self._free_weights()
            p[chosen] = _project_on_simplex(p0[chosen], (self.lbp[chosen], self.ubp[chosen]), total)
        return p

    def lower_start(self, w0: np.ndarray) -> np.ndarray:
        """Start of the lower level, checked; shape (n_w,).

        Raises:
            ProblemError: w0 has another shape or an entry that is not a number.
        """
        n_w = self.nlp.w.numel()
        if w0.shape != (n_w,):
            raise ProblemError(f"w0 must have shape ({n_w},), got {w0.shape}")
        bad = np.flatnonzero(~np.isfinite(w0))
        if bad.size:
            raise ProblemError(f"w0[{bad[0]}] is {w0[bad[0]]}: give a finite number")
        return w0

    def _check_shapes(self) -> None:
        n_p, n_u = self.n_p, self.upper.numel()
        expected = {"free": n_p, "lbp": n_p, "ubp": n_p, "p_nominal": n_p, "lbu": n_u, "ubu": n_u}
        for name, n in expected.items():
            shape = getattr(self, name).shape
            if shape != (n,):
                raise ProblemError(f"{name} must have shape ({n},), got {shape}")
        if self.free.dtype != np.bool_:
            raise ProblemError(f"free must hold booleans, got {self.free.dtype}")
        if not np.any(self.free):
            raise ProblemError("no entry of p is free: nothing is to be estimated")
        if self.residual.numel() == 0 or self.residual.shape[1] != 1:
            raise ProblemError(f"residual must have shape (n_m, 1) with n_m > 0, got {self.residual.shape}")
        if self.names and len(self.names) != n_p:
            raise ProblemError(f"names must have {n_p} entries, got {len(self.names)}")

    def _check_symbols(self) -> None:
        for name, expression in [("residual", self.residual), ("upper", self.upper)]:
            function = ca.Function(name, [self.nlp.w, self.nlp.p], [expression], {"allow_free": True})
            foreign = ", ".join(function.get_free())
            if foreign:
                raise ProblemError(f"{name} depends on {foreign}, which is neither in nlp.w nor in nlp.p")

    def _check_bounds(self) -> None:
        self._check_finite("p_nominal", self.p_nominal)
        for i in self.free_index:
            if not self.lbp[i] <= self.ubp[i]:
                name = self.parameter_name(i)
                raise ProblemError(f"bounds of {name} cross: lower {self.lbp[i]}, upper {self.ubp[i]}")
        crossed = np.flatnonzero(~(self.lbu <= self.ubu))
        if crossed.size:
            raise ProblemError(f"bounds of upper-level constraint {crossed[0]} cross")

    def _check_simplex(self) -> None:
        if not self.simplex:
            return
        inside = all(0 <= i < self.n_p for i in self.simplex) and len(set(self.simplex)) == len(self.simplex)
        if not inside or not any(self.free[i] for i in self.simplex):
            raise ProblemError(f"simplex must list different entries of p, one of them free, got {self.simplex}")
        chosen, total = self._free_weights()
        lowest, highest = self.lbp[chosen].sum(), self.ubp[chosen].sum()
        if not lowest <= total <= highest:
            raise ProblemError(
                f"the bounds of the weights sum to {lowest:g}..{highest:g}: they cannot sum to {total:g}"
            )

    def _free_weights(self) -> tuple[list[int], float]:
        """Free entries of the simplex, and what is left of one for them."""
        fixed = [i for i in self.simplex if not self.free[i]]
        return [i for i in self.simplex if self.free[i]], 1.0 - float(self.p_nominal[fixed].sum())

    def _check_finite(self, name: str, values: np.ndarray) -> None:
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise ProblemError(f"{name} of {self.parameter_name(bad[0])} is {values[bad[0]]}: give a finite number")


def _project_on_simplex(x: np.ndarray, limits: tuple[np.ndarray, np.ndarray], total: float) -> np.ndarray:
    # The Euclidean projection is clip(x - t) with the t that makes the sum right; the sum falls monotonically in t.
    bounds = np.concatenate([*limits, np.ones(1)])
    span = float(np.max(np.abs(x)) + np.max(np.abs(bounds[np.isfinite(bounds)]))) + 1.0
    low, high = -span, span
    for _ in range(200):
        middle = 0.5 * (low + high)
        if np.clip(x - middle, *limits).sum() > total:
            low = middle
        else:
            high = middle
    return np.clip(x - 0.5 * (low + high), *limits)
