"""Multi-stage optimal control of mechanical systems with changing contacts.

The state is (q, v), the control the acceleration a and the contact forces f. Actuator torques are functions of
(q, v, a, f) by inverse dynamics, so they appear in criteria, not among the unknowns; what cannot be actuated must
vanish. Criteria are functions of such outputs y and of v, which keeps their second derivatives cheap:
the Hessian of phi(y(z), v) is J' phi'' J plus that of phi'_y y(z).
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..errors import ProblemError


@dataclass(frozen=True, kw_only=True)
class MechanicalModel:
    """Expressions of a mechanical system; everything numeric is a parameter."""

    q: ca.SX
    """Coordinates, shape (n_q, 1)."""
    v: ca.SX
    """Velocities dq/dt, shape (n_q, 1)."""
    a: ca.SX
    """Accelerations, shape (n_q, 1)."""
    f: ca.SX
    """Contact force components, scaled, shape (n_f, 1)."""
    p: ca.SX
    """Parameters of the system, shape (n_p, 1)."""
    d: ca.SX
    """Data that vary along time, for instance which side stands, shape (n_d, 1)."""
    outputs: ca.SX
    """Quantities y(q, v, a, f; p); the first n_residual are zero (what is not actuated), shape (n_y, 1)."""
    n_residual: int
    y: ca.SX
    """Symbol that stands for the outputs in `criteria`, shape (n_y, 1)."""
    criteria: ca.SX
    """Running criteria, of (y, v, d; p), shape (n_criteria, 1)."""
    positions: ca.SX
    """Contact coordinate that each force component works on, of (q; p) [m], shape (n_f, 1)."""
    velocities: ca.SX
    """Their rates, of (q, v; p) [m/s], shape (n_f, 1)."""

    def __post_init__(self) -> None:
        if self.outputs.shape != self.y.shape:
            raise ProblemError(f"y must have the shape of the outputs, {self.outputs.shape}, got {self.y.shape}")
        for name in ("positions", "velocities"):
            shape = getattr(self, name).shape
            if shape != self.f.shape:
                raise ProblemError(f"{name} must have the shape of f, {self.f.shape}, got {shape}")


@dataclass(frozen=True, kw_only=True)
class ContactStage:
    """A stretch of time with the same contacts."""

    duration: float
    """[s]"""
    n_intervals: int
    active: tuple[int, ...]
    """Force components that may be nonzero; their contact coordinates stay where they are."""
    landing: tuple[int, ...]
    """Contact coordinates whose rate is zero when this stage begins, besides those that the stage before holds."""
    grounded: tuple[int, ...]
    """Contact coordinates that are zero when this stage begins (heights of points that land)."""
    clear: tuple[int, ...]
    """Contact coordinates that must not be negative during the stage (heights of free points)."""
    force_cone: np.ndarray
    """Rows a with a f >= 0 (unilateral, friction), shape (n_rows, n_f)."""
    data: np.ndarray
    """Value of `MechanicalModel.d`, shape (n_d,)."""
    label: str = ""

    def __post_init__(self) -> None:
        if self.duration <= 0.0 or self.n_intervals < 1:
            raise ProblemError(
                f"stage '{self.label}' needs a positive duration and at least one interval, "
                f"got {self.duration:g} s and {self.n_intervals}"
            )
        loaded = {int(i) for i in np.nonzero(self.force_cone)[1]}
        if not loaded <= set(self.active):
            raise ProblemError(
                f"the force cone of stage '{self.label}' may only use active components {sorted(self.active)}, "
                f"it uses {sorted(loaded - set(self.active))} too"
            )
