"""One stage of an optimal control problem."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from ..errors import ProblemError
from .constraint import NO_CONSTRAINT, Bounds, Constraint
from .symbols import require_known, require_shape, require_symbols


def _nothing() -> ca.SX:
    return ca.SX(0, 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Stage:
    r"""A stretch of time with one set of differential equations.

    .. math::

        \dot{x} = f(t, x, u; q, p), \quad t \in [0, T(q, p)], \qquad
        \underline{c} \le c(t, x, u; q, p) \le \overline{c}

    Its share of the criteria is :math:`\phi_i(x(T); q, p) + \int_0^T \ell_i(t, x, u; q, p) \, dt` (Hatz 2014, (4.7)).
    The control values q and the parameters p belong to the problem, see `problem.MultiStageProblem`.

    Raises:
        ProblemError: A shape is wrong or a bound is empty.
    """

    name: str
    x: ca.SX
    """State, symbols of shape (n_x, 1)."""
    u: ca.SX = field(default_factory=_nothing)
    """Control, symbols of shape (n_u, 1)."""
    t: ca.SX = field(default_factory=lambda: ca.SX.sym("t"))
    """Time since the stage began [s], a symbol."""
    ode: ca.SX
    """dx/dt, shape (n_x, 1)."""
    duration: ca.SX | float
    """T [s]; free where it depends on control values q."""
    mayer: Mapping[str, ca.SX] = field(default_factory=dict[str, ca.SX])
    """Criterion name to its term at the end of the stage, of (x, q, p)."""
    lagrange: Mapping[str, ca.SX] = field(default_factory=dict[str, ca.SX])
    """Criterion name to its integrand over time [s], of (t, x, u, q, p)."""
    x_bounds: Bounds | None = None
    """Bounds on the state at all times; none if left out."""
    u_bounds: Bounds | None = None
    """Bounds on the control at all times; none if left out."""
    start: Bounds | None = None
    """Bounds on x(0), instead of `x_bounds` there; equal bounds fix a value."""
    end: Bounds | None = None
    """Bounds on x(T), instead of `x_bounds` there; equal bounds fix a value."""
    path: Constraint = NO_CONSTRAINT
    """Mixed constraints c of (t, x, u, q, p) at all times."""

    def __post_init__(self) -> None:
        for what in ("x", "u", "t"):
            require_symbols(f"{what} of stage '{self.name}'", getattr(self, what))
        if self.n_x == 0:
            raise ProblemError(f"stage '{self.name}' has no state")
        require_shape(f"the ode of stage '{self.name}'", self.ode, self.x.shape)
        for kind, terms in (("Mayer", self.mayer), ("Lagrange", self.lagrange)):
            for name, term in terms.items():
                require_shape(f"the {kind} term '{name}' of stage '{self.name}'", ca.SX(term), (1, 1))
        require_shape(f"the duration of stage '{self.name}'", ca.SX(self.duration), (1, 1))
        for what, bounds, n in (
            ("x_bounds", self.x_bounds, self.n_x),
            ("start", self.start, self.n_x),
            ("end", self.end, self.n_x),
            ("u_bounds", self.u_bounds, self.n_u),
        ):
            if bounds is not None and bounds.size != n:
                raise ProblemError(f"{what} of stage '{self.name}' must have size {n}, got {bounds.size}")

    @property
    def n_x(self) -> int:
        """Number of states."""
        return self.x.numel()

    @property
    def n_u(self) -> int:
        """Number of controls."""
        return self.u.numel()

    @property
    def state_bounds(self) -> Bounds:
        """Bounds on x inside the stage."""
        return self.x_bounds or Bounds.none(self.n_x)

    @property
    def control_bounds(self) -> Bounds:
        """Bounds on u."""
        return self.u_bounds or Bounds.none(self.n_u)

    def bounds_at(self, *, start: bool, end: bool) -> Bounds:
        """Bounds on x at a node that may be the stage's first or last."""
        special = self.start if start else self.end if end else None
        return special or self.state_bounds

    def check(self, q: ca.SX, p: ca.SX) -> None:
        """Raise `errors.ProblemError` where an expression uses symbols that it may not use."""
        where = f"of stage '{self.name}'"
        everything = (self.t, self.x, self.u, q, p)
        require_known(f"the ode {where}", self.ode, everything)
        require_known(f"the duration {where}", ca.SX(self.duration), (q, p))
        require_known(f"path constraint '{self.path.name}' {where}", self.path.expression, everything)
        for name, term in self.lagrange.items():
            require_known(f"the Lagrange term '{name}' {where}", ca.SX(term), everything)
        for name, term in self.mayer.items():
            require_known(f"the Mayer term '{name}' {where}", ca.SX(term), (self.x, q, p))


def fixed(*values: float) -> Bounds:
    """Bounds that fix all values."""
    value = np.array(values, dtype=float)
    return Bounds(lower=value, upper=value)
