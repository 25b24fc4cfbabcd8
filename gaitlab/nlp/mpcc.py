"""Mathematical programs with complementarity constraints."""

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from ..errors import ProblemError


@dataclass(frozen=True, kw_only=True)
class MPCC:
    r"""Nonlinear program whose variables also complement each other.

    .. math::

        \underset{w}{\text{minimize}} \; f(w, p) \quad \text{subject to} \quad
        \underline{g} \le g(w, p) \le \overline{g}, \;
        \underline{w} \le w \le \overline{w}, \;
        0 \le G(w, p) \perp H(w, p) \ge 0

    In programs that come from a lower level, G are its inequality constraints and H their multipliers.

    Raises:
        ProblemError: A shape is wrong, bounds cross, or an expression has symbols that are not in (w, p).
    """

    w: ca.SX
    """Variables, shape (n_w, 1)."""
    f: ca.SX
    """Objective, scalar."""
    G: ca.SX
    """First halves of the pairs, shape (n_c, 1)."""
    H: ca.SX
    """Second halves of the pairs, shape (n_c, 1)."""
    lbw: np.ndarray
    """Lower bounds on `w`, shape (n_w,)."""
    ubw: np.ndarray
    """Upper bounds on `w`, shape (n_w,)."""
    g: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    """Constraints, shape (n_g, 1)."""
    lbg: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Lower bounds on `g`, shape (n_g,)."""
    ubg: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Upper bounds on `g`, shape (n_g,)."""
    p: ca.SX = field(default_factory=lambda: ca.SX(0, 1))
    """Parameters, shape (n_p, 1)."""
    residual: ca.SX | None = None
    """Where given, shape (n_m, 1), f is half its sum of squares, and solvers that take second derivatives get the
    Gauss-Newton approximation: curvature of the residual and of the constraints is left out."""

    def __post_init__(self) -> None:
        self._check_shapes()
        for name, lower, upper in [("w", self.lbw, self.ubw), ("g", self.lbg, self.ubg)]:
            crossed = np.flatnonzero(~(lower <= upper))
            if crossed.size:
                i = crossed[0]
                raise ProblemError(f"bounds of {name}[{i}] cross: lower {lower[i]}, upper {upper[i]}")
        every = ca.Function("all", [self.w, self.p], [self.f, self.g, self.G, self.H], {"allow_free": True})
        if every.get_free():
            raise ProblemError(f"the functions depend on {', '.join(every.get_free())}, which is neither in w nor in p")

    def _check_shapes(self) -> None:
        n_w, n_g = self.w.numel(), self.g.numel()
        for name, n in [("lbw", n_w), ("ubw", n_w), ("lbg", n_g), ("ubg", n_g)]:
            shape = getattr(self, name).shape
            if shape != (n,):
                raise ProblemError(f"{name} must have shape ({n},), got {shape}")
        if self.G.shape != self.H.shape:
            raise ProblemError(f"G and H must have the same shape, got {self.G.shape} and {self.H.shape}")
        if self.f.numel() != 1:
            raise ProblemError(f"f must be scalar, got {self.f.shape}")

    @property
    def n_pairs(self) -> int:
        """Number of complementarity constraints."""
        return self.G.numel()

    def check_start(self, w0: np.ndarray) -> None:
        """Refuse a start that does not have shape (n_w,) or is not finite.

        Raises:
            ProblemError: Says which entry.
        """
        if w0.shape != (self.w.numel(),):
            raise ProblemError(f"w0 must have shape ({self.w.numel()},), got {w0.shape}")
        bad = np.flatnonzero(~np.isfinite(w0))
        if bad.size:
            raise ProblemError(f"w0[{bad[0]}] is {w0[bad[0]]}: give a finite number")
