"""How one stage passes into the next."""

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True, kw_only=True, eq=False)
class Transition:
    r"""Stage transition :math:`x_{k+1}(0) = b_k(x_k(T_k); q, p)` (Hatz 2014, (4.11)); a jump where b is not x."""

    next_state: ca.SX
    """b_k of the earlier stage's x, of q and of p; shape (n_x of the later stage, 1)."""


def continuous(x: ca.SX) -> Transition:
    """Transition without a jump, for the earlier stage's state x, shape (n_x, 1)."""
    return Transition(next_state=x)
