"""Identified weights with their uncertainty."""

from dataclasses import dataclass

import numpy as np

from .problem import Response


@dataclass(frozen=True, kw_only=True)
class WeightEstimate:
    """Result of an inverse problem."""

    theta: np.ndarray
    """Weights on the simplex, shape (n_theta,)."""
    response: Response
    """Solution of the lower level for these weights."""
    covariance: np.ndarray
    """Covariance of the weights, shape (n_theta, n_theta); infinite where the data do not tell."""
    identifiable: np.ndarray
    """Which weights the data tell, shape (n_theta,)."""
    condition: float
    """Condition number of the Gauss-Newton matrix on the simplex."""
    converged: bool
    reason: str
    iterations: int
    lower_iterations: int
    """Iterations of the lower level's solver in all."""

    @property
    def rms(self) -> float:
        """Root mean square of the residual."""
        return rms(self.response.residual)


def rms(residual: np.ndarray) -> float:
    """Root mean square of a vector, shape (n,)."""
    return float(np.sqrt(np.mean(residual**2)))
