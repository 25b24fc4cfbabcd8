"""Levenberg-Marquardt on the marker distances of all frames of a trial together.

The normal equations are banded: 3 n_q wide with smoothness, n_q without. Their Cholesky factor is kept for more steps
while these shrink fast, as the matrix hardly changes near the minimum.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from gaitlab.inverse.kinematics_settings import InverseKinematicsSettings
from gaitlab.inverse.marker_moments import (
    MarkerMoments,
    Slope,
    gauss_newton_matrix,
    marker_moments,
    marker_slope,
)
from gaitlab.multibody.subject import SubjectModel

SHRINKING = 0.7
"""Steps that shrink at least by this factor keep the factorised matrix, after the second."""

UNDAMPED = 1e-9
"""Smallest Levenberg damping, relative to the diagonal."""


@dataclass(frozen=True, kw_only=True)
class MarkerFit:
    """Result of the minimisation."""

    q: np.ndarray
    """Coordinates [m, rad], shape (n, n_q)."""
    iterations: int
    converged: bool


@dataclass(frozen=True, kw_only=True)
class FitProblem:
    """What to minimise."""

    subject: SubjectModel
    moments: MarkerMoments
    rate: float
    """Frames per second [Hz]."""
    settings: InverseKinematicsSettings
    start: np.ndarray
    """Coordinates that the prior holds to, shape (n, n_q)."""


@dataclass(frozen=True, kw_only=True)
class _Penalties:
    """Weights of smoothness, limits and prior per coordinate, in units of the markers' squared distances."""

    smoothness: np.ndarray
    """lambda / dt^4, shape (n_q,)."""
    limit: np.ndarray
    """Of leaving the range, shape (n_q,)."""
    lower: np.ndarray
    """Lowest coordinate [m, rad], shape (n_q,)."""
    upper: np.ndarray
    """Highest coordinate [m, rad], shape (n_q,)."""
    prior: np.ndarray
    """Of leaving the start, shape (n_q,)."""
    start: np.ndarray
    """Where the prior pulls to, shape (n, n_q)."""

    def excess(self, q: np.ndarray) -> np.ndarray:
        """How far coordinates lie outside their range [m, rad], shape (n, n_q)."""
        return q - np.clip(q, self.lower, self.upper)

    def cost(self, q: np.ndarray) -> float:
        """Sum of the penalties [m^2]."""
        bend, drift = np.diff(q, n=2, axis=0), self.prior * (q - self.start) ** 2
        return float((self.smoothness * bend**2).sum() + (self.limit * self.excess(q) ** 2 + drift).sum())


def _penalties(problem: FitProblem, matrix: np.ndarray) -> _Penalties:
    stiffness = np.diagonal(matrix, axis1=1, axis2=2).mean(axis=0)
    stiffness = np.maximum(stiffness, 1e-6 * stiffness.max())
    smoothness = np.zeros_like(stiffness)
    settings = problem.settings
    if settings.agility is not None:
        smoothness[:] = (settings.agility * problem.rate**2) ** 2
    elif settings.cut_off > 0:
        smoothness = stiffness * (problem.rate / (2 * np.pi * settings.cut_off)) ** 4
    lower, upper = settings.limits(problem.subject)
    prior = np.full_like(stiffness, settings.prior_lever**2)
    prior[:3] = 1e-6
    return _Penalties(
        smoothness=smoothness,
        limit=settings.limit_weight * stiffness,
        lower=lower,
        upper=upper,
        prior=prior,
        start=problem.start,
    )


def marker_information(subject: SubjectModel, markers: Mapping[str, np.ndarray], q: np.ndarray) -> np.ndarray:
    """What the markers of each frame tell of the coordinates: sum of J'J over its markers, shape (n, n_q, n_q).

    Divided by the variance of a marker's coordinate [m^2] it is the inverse covariance of the coordinates that fit the
    markers best. J is a marker's derivative in the coordinates [m/m, m/rad].

    Args:
        subject: Model with markers.
        markers: Name to positions in the gait frame [m], shapes (n, 3), NaN where missing; unknown names are ignored.
        q: Coordinates [m, rad], shape (n, n_q).
    """
    known = {name: markers[name] for name in subject.markers if name in markers}
    moments = marker_moments(subject, dict(subject.markers), known, {})
    return gauss_newton_matrix(subject, moments, marker_slope(subject, moments, q))


def minimise(problem: FitProblem) -> MarkerFit:
    """Coordinates with the least cost near the start; not converged is a result."""
    q, damping, matrix = problem.start, UNDAMPED, None
    here = marker_slope(problem.subject, problem.moments, q)
    moved, factor, penalties = np.inf, None, None
    for iteration in range(1, problem.settings.max_iterations + 1):
        if factor is None:
            matrix = gauss_newton_matrix(problem.subject, problem.moments, here)
            penalties = penalties or _penalties(problem, matrix)
            factor = _factorise(matrix, penalties, q, damping)
        assert penalties is not None
        step = cho_solve_banded((factor, True), _gradient(here, penalties, q).ravel(), check_finite=False)
        trial = q - step.reshape(q.shape)
        there = marker_slope(problem.subject, problem.moments, trial)
        previous, moved = moved, float(np.abs(step).max())
        if _value(there, penalties, trial) <= _value(here, penalties, q) * (1 + 1e-12):
            q, here = trial, there
            fresh, damping = iteration == 1 or moved > SHRINKING * previous, max(damping / 10, UNDAMPED)
        else:
            fresh, damping = True, max(damping * 30, 1e-4)
        if moved < problem.settings.tolerance:
            return MarkerFit(q=q, iterations=iteration, converged=True)
        factor = None if fresh else factor
    return MarkerFit(q=q, iterations=problem.settings.max_iterations, converged=False)


def _value(slope: Slope, penalties: _Penalties, q: np.ndarray) -> float:
    return float(slope.cost.sum()) + penalties.cost(q)


def _gradient(slope: Slope, penalties: _Penalties, q: np.ndarray) -> np.ndarray:
    """Half the gradient of the whole cost, shape (n, n_q)."""
    gradient = slope.gradient + penalties.limit * penalties.excess(q) + penalties.prior * (q - penalties.start)
    pull = penalties.smoothness * np.diff(q, n=2, axis=0)
    gradient[:-2] += pull
    gradient[1:-1] -= 2 * pull
    gradient[2:] += pull
    return gradient


def _factorise(matrix: np.ndarray, penalties: _Penalties, q: np.ndarray, damping: float) -> np.ndarray:
    """Banded Cholesky factor of the damped Gauss-Newton matrix of the whole cost."""
    n, n_q = q.shape
    diagonal = np.diagonal(matrix, axis1=1, axis2=2)
    extra = penalties.limit * (penalties.excess(q) != 0) + penalties.prior
    reach = 2 if penalties.smoothness.any() and n > 2 else 1
    band = np.zeros((reach * n_q + 1, n, n_q))
    for k in range(n_q):
        band[k, :, : n_q - k] = np.diagonal(matrix, offset=-k, axis1=1, axis2=2)
    band[0] += extra + damping * (diagonal + diagonal.mean(axis=0))
    if reach == 2:
        _add_smoothness(band, penalties.smoothness)
    return cholesky_banded(band.reshape(len(band), -1), lower=True, overwrite_ab=True, check_finite=False)


def _add_smoothness(band: np.ndarray, smoothness: np.ndarray) -> None:
    """Add lambda D'D of second differences D to the lower band, shape (2 n_q + 1, n, n_q)."""
    n, n_q = band.shape[1:]
    middle, beside = np.full(n, 6.0), np.full(n - 1, -4.0)
    middle[[0, -1]], beside[[0, -1]] = 1.0, -2.0
    middle[[1, -2]] = 5.0 if n > 3 else 4.0
    band[0] += middle[:, None] * smoothness
    band[n_q, :-1] += beside[:, None] * smoothness
    band[2 * n_q, :-2] += smoothness
