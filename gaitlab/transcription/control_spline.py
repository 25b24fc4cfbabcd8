"""Controls as cubic splines through equidistant nodes."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from scipy.interpolate import CubicSpline

from ..errors import ProblemError

Ends = Literal["clamped", "natural", "not-a-knot"]


@dataclass(frozen=True, kw_only=True)
class ControlSpline:
    r"""Cubic spline interpolation, :math:`u(t) = C(t) \bar{u}` (Zallinger et al. 2025, (12)).

    Raises:
        ProblemError: Too few nodes.
    """

    n_nodes: int = 20
    """Nodes of each control; the source takes k = 20."""
    ends: Ends = "clamped"
    """End conditions. The source does not print them: with zero slopes ("clamped") its example 5.1 starts from
    1.504 N and ends at 1.251 N as printed; natural ends give 1.497 and 1.2527, not-a-knot 1.486 and 1.2542."""

    def __post_init__(self) -> None:
        if self.n_nodes < 4:
            raise ProblemError(f"a cubic spline needs at least 4 nodes, got {self.n_nodes}")

    def matrix(self, duration: float, n_controls: int, times: np.ndarray, derivative: int = 0) -> np.ndarray:
        """C(t) or a time derivative of it at times [s], shape (n,); result (n, n_controls, n_nodes n_controls).

        The nodes are ordered by time, all controls of one node together.
        """
        values = _basis(self.n_nodes, self.ends, duration)(times, derivative)  # (n, n_nodes)
        return np.kron(values[:, None, :], np.eye(n_controls)[None])

    def controls(self, duration: float, nodes: np.ndarray, times: np.ndarray, derivative: int = 0) -> np.ndarray:
        """Controls or a time derivative of them for nodes (n_nodes, n_u) at times [s], shape (n,); result (n, n_u)."""
        return _basis(self.n_nodes, self.ends, duration)(times, derivative) @ nodes


@lru_cache(maxsize=16)
def _basis(n_nodes: int, ends: Ends, duration: float) -> CubicSpline:
    return CubicSpline(np.linspace(0.0, duration, n_nodes), np.eye(n_nodes), bc_type=ends)
