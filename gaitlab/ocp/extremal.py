r"""Criteria made of extremal values: the largest value that outputs of a system reach over time.

Two forms of one criterion. The minimax form of `ExtremalProblem` counts the refined local maxima themselves; the
smooth form of `power_of_p_norm` is the integrand of a p-norm over time, whose root tends to the largest value as the
exponent grows. The second one needs no search for maxima, so it also serves as a running criterion of a transcribed
lower level; `epigraph` puts the first one there.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..errors import ProblemError


@dataclass(frozen=True, kw_only=True)
class ExtremalProblem:
    r"""Smallest extremal value of system outputs between two states (Zallinger et al. 2025, (1), (3), (30)).

    .. math::

        \underset{u(\cdot)}{\text{minimize}} \; \max_{i, t} h_i(x(t), u(t), t) \quad \text{subject to} \quad
        \dot{x} = f(x, u, t), \; x(0) = x_0, \; \phi(x(t_F)) = 0, \; \underline{u} \le \bar{u}_j \le \overline{u}

    with a fixed duration :math:`t_F`; the controls are splines through the nodes :math:`\bar{u}_j`, at which alone
    they are bounded.
    """

    x: ca.SX
    """States, shape (n_x, 1)."""
    u: ca.SX
    """Controls, shape (n_u, 1)."""
    t: ca.SX
    """Time [s], scalar."""
    dynamics: ca.SX
    """dx/dt as a function of (x, u, t), shape (n_x, 1)."""
    outputs: ca.SX
    """h(x, u, t), whose largest component counts, shape (n_h, 1)."""
    terminal: ca.SX
    """phi(x), zero at the end, shape (n_phi, 1)."""
    x0: np.ndarray
    """State at the start, shape (n_x,)."""
    duration: float
    """[s]"""
    lower: np.ndarray
    """Lower bounds on the nodes of each control, shape (n_u,)."""
    upper: np.ndarray
    """Upper bounds on the nodes of each control, shape (n_u,)."""

    def __post_init__(self) -> None:
        n_x, n_u = self.x.numel(), self.u.numel()
        for name, shape, expected in (
            ("dynamics", self.dynamics.shape, (n_x, 1)),
            ("x0", self.x0.shape, (n_x,)),
            ("lower", self.lower.shape, (n_u,)),
            ("upper", self.upper.shape, (n_u,)),
        ):
            if shape != expected:
                raise ProblemError(f"{name} must have shape {expected}, got {shape}")
        if not self.outputs.numel():
            raise ProblemError("an extremal problem needs at least one output, got none")
        if not 0.0 < self.duration < np.inf:
            raise ProblemError(f"the duration must be positive and finite, got {self.duration:g} s")
        if np.any(self.lower > self.upper):
            raise ProblemError(f"control bounds cross: lower {self.lower}, upper {self.upper}")


def power_of_p_norm(values: ca.SX, exponent: int) -> ca.SX:
    r"""Sum of :math:`|h_i|^\alpha` of values, shape (n_h, 1): its time integral is the p-norm to the power alpha.

    Divide the values by a typical peak first, so that the power neither over- nor underflows. The exponent is even.

    Raises:
        ProblemError: The exponent is odd or not positive, so that negative values would count as gains.
    """
    if exponent < 2 or exponent % 2:
        raise ProblemError(f"the exponent must be even and positive, got {exponent}")
    return ca.sum1(values**exponent)
