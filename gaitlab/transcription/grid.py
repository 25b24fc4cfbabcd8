"""How a stage is cut into intervals."""

from dataclasses import dataclass

import numpy as np

from ..errors import ProblemError


@dataclass(frozen=True, kw_only=True, eq=False)
class Grid:
    """Nodes as fractions of the stage's duration.

    Raises:
        ProblemError: The nodes do not increase from 0 to 1.
    """

    nodes: np.ndarray
    """From 0 to 1, shape (N + 1,)."""

    def __post_init__(self) -> None:
        good = self.nodes.ndim == 1 and self.nodes.size >= 2 and self.nodes[0] == 0.0 and self.nodes[-1] == 1.0
        if not good or not np.all(np.diff(self.nodes) > 0.0):
            raise ProblemError(f"the nodes of a grid must increase from 0 to 1, got {self.nodes}")

    @property
    def n(self) -> int:
        """Number of intervals N."""
        return self.nodes.size - 1

    @property
    def data(self) -> np.ndarray:
        """Start and width of each interval, shape (N, 2)."""
        return np.column_stack([self.nodes[:-1], np.diff(self.nodes)])

    def locate(self, time: float) -> tuple[int, float]:
        """Interval that holds a fraction of the stage, and the fraction of that interval; nodes are starts but 1."""
        # Times such as 3 * 0.05 miss their node by rounding.
        near = int(np.argmin(np.abs(self.nodes - time)))
        if abs(self.nodes[near] - time) < 1e-12:
            return (near, 0.0) if near < self.n else (self.n - 1, 1.0)
        k = int(np.searchsorted(self.nodes, time)) - 1
        return k, float((time - self.nodes[k]) / (self.nodes[k + 1] - self.nodes[k]))


def uniform(n_intervals: int) -> Grid:
    """Grid of equal intervals."""
    if n_intervals < 1:
        raise ProblemError(f"a grid needs at least one interval, got {n_intervals}")
    return Grid(nodes=np.linspace(0.0, 1.0, n_intervals + 1))
