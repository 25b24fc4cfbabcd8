"""Inverse optimal control: which weights of the lower level's criteria explain measurements.

Upper level (Hatz 2014, (4.4)): minimise 1/2 |r(w*(theta))|^2 over weights theta >= 0 with sum 1, where w*(theta)
solves the lower level (4.6).
"""

from typing import Protocol

import numpy as np

from ..nlp.sparse_solution import SparseSolution


class Response(Protocol):
    """What the upper level needs to know about one solution of the lower level."""

    @property
    def solution(self) -> SparseSolution:
        """Certified solution for one theta."""
        ...

    @property
    def residual(self) -> np.ndarray:
        """Model minus measurement, shape (n_m,)."""
        ...

    def residual_by_time(self) -> np.ndarray:
        """The same numbers, shape (n_times, n_channels)."""
        ...

    def jacobian(self) -> np.ndarray:
        """Derivative of the residual in theta by the implicit function theorem, shape (n_m, n_theta)."""
        ...

    def predict(self, step: np.ndarray) -> SparseSolution:
        """First-order prediction of the solution after a step in theta, shape (n_theta,)."""
        ...


class LowerLevel(Protocol):
    """A parametric optimal control problem and its measurements."""

    @property
    def n_theta(self) -> int:
        """Number of weights."""
        ...

    def respond(self, theta: np.ndarray, start: SparseSolution) -> Response:
        """Solve for theta, shape (n_theta,), from a nearby solution. Not converging shows in the status."""
        ...
