"""Damping of steps in the given states, node by node.

An arc's optimum bends where a contact force starts or ends. A step beyond such a bend does not do what was predicted,
but only in this arc: only its two states are held back then, and the rest of the walk goes on with full steps. A
common factor creeps along with the worst arc (a noisy demo walk: not at rest after 25 iterations, here after 8 to 23).
"""

from dataclasses import dataclass

import numpy as np

EASED, HELD = 10.0, 10.0
MOST = 1e7
"""Holds a state still; more would only take longer to ease."""


@dataclass(eq=False)
class NodeDamping:
    """Marquardt factors of the given states, which its methods change."""

    scale: np.ndarray
    """Step of a state that costs as much as a standard deviation of the data [m, rad, m/s, rad/s], shape (2 n_q,)."""
    factors: np.ndarray
    """One per given state, shape (n_given,)."""
    least: float
    """Factors do not fall below: what data leave open stays within scale / sqrt(least)."""

    @property
    def diagonal(self) -> np.ndarray:
        """What is added to the diagonal of the normal matrix, shape (n_given * 2 n_q,)."""
        return np.outer(self.factors, 1.0 / self.scale**2).ravel()

    def ease(self, surprised: np.ndarray) -> None:
        """After a step that helped: longer ones, but not for arcs (n_given - 1,) that surprised on the way to it."""
        held = states_of_arcs(surprised)
        self.factors = np.where(held, self.factors, np.maximum(self.factors / EASED, self.least))

    def hold(self, surprised: np.ndarray, attempt: int) -> None:
        """After a step that did not help: shorter ones for arcs (n_given - 1,) that surprised.

        The more so the more attempts have failed: a bend may be near. Where none did, or those that did stand still
        already, everything is held back.
        """
        held = states_of_arcs(surprised)
        if np.all(self.factors[held] >= MOST):  # also where no arc surprised
            held[:] = True
        self.factors = np.where(held, np.minimum(HELD ** (attempt + 1) * self.factors, MOST), self.factors)


def states_of_arcs(arcs: np.ndarray) -> np.ndarray:
    """Given states, shape (n_given,), at either end of marked arcs, shape (n_given - 1,)."""
    marked = np.zeros(len(arcs) + 1, dtype=bool)
    marked[:-1] |= arcs
    marked[1:] |= arcs
    return marked
