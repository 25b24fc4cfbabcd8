"""Local maxima in time of the outputs of a simulation, refined between its grid points.

Grid points with nearly as large values accompany them as guards: a step of an optimiser that lowers the maxima alone
lets the outputs rise beside them, above all where they form a plateau.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .interval_functions import IntervalFunctions

ROOT_ITERATIONS = 60
"""Enough to halve an interval down to the last digit; Newton's steps end far earlier."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Probes:
    """Points in time, each within an interval of a simulation, and the output that is looked at."""

    intervals: np.ndarray
    """Index of the interval, shape (n,)."""
    components: np.ndarray
    """Index of the output, shape (n,)."""
    shares: np.ndarray
    """Place in the interval as a share of its length, 0 to 1, shape (n,)."""
    y: np.ndarray
    """State at the interval's start, its three controls, control and its slope at the probe, shape (n, n_y)."""
    ddu: np.ndarray
    """Second time derivative of the control [1/s^2], shape (n, n_u)."""
    starts: np.ndarray
    """Time at which the interval starts [s], shape (n,)."""
    step: float
    """Length of the intervals [s]."""
    selection: np.ndarray
    """One for the output that is looked at, shape (n, n_h)."""

    @property
    def inputs(self) -> tuple[np.ndarray, ...]:
        """What the functions of `IntervalFunctions` take: y', starts, shares, selection'; shapes (..., n)."""
        return self.y.T, self.starts[None], self.shares[None], self.selection.T


@dataclass(frozen=True, kw_only=True, eq=False)
class Peaks:
    """Local maxima, the ends of the time span included where the output rises towards them; then the guards."""

    probes: Probes
    times: np.ndarray
    """[s], shape (n_i,)."""
    values: np.ndarray
    """Outputs there, shape (n_i,)."""
    is_peak: np.ndarray
    """False for guards, shape (n_i,)."""
    measure: np.ndarray
    """Weights of the trapezoidal rule for the mean over time and outputs; zero for peaks, shape (n_i,)."""
    inverse_curvatures: np.ndarray
    """1 / (d2h/dt2) [s^2], negative; zero for what does not move (ends of the time span, guards), shape (n_i,)."""
    gradients: np.ndarray
    """Gradient of each value in y, shape (n_i, n_y)."""
    slope_gradients: np.ndarray
    """Gradient of each dh/dt in y, shape (n_i, n_y)."""


Place = Callable[[np.ndarray, np.ndarray, np.ndarray], Probes]
"""(intervals, components, shares) -> probes, shapes (n,)."""


def find_peaks(
    functions: IntervalFunctions, place: Place, outputs: np.ndarray, slopes: np.ndarray, guarded: float
) -> Peaks:
    """Peaks of outputs that are known with their slopes at the grid points, shapes (N + 1, n_h).

    A maximum is seen where the slope changes its sign from one grid point to the next. Grid points guard the share
    `guarded` of the outputs' range below its top.
    """
    rising, n = slopes > 0.0, len(slopes) - 1
    intervals, components = np.nonzero(rising[:-1] & ~rising[1:])
    shares = _roots(functions, place, intervals, components, slopes)
    first, last = np.flatnonzero(~rising[0]), np.flatnonzero(rising[-1])
    nodes, guards = np.nonzero(outputs >= outputs.max() - guarded * np.ptp(outputs)) if guarded else (first[:0],) * 2
    probes = place(
        np.concatenate([intervals, np.zeros_like(first), np.full_like(last, n - 1), np.minimum(nodes, n - 1)]),
        np.concatenate([components, first, last, guards]),
        np.concatenate([shares, np.zeros(len(first)), np.ones(len(last)), nodes == n]),
    )
    values, _, curvatures = probe(functions, probes)
    order, trapezoid = np.arange(len(values)), np.where((nodes == 0) | (nodes == n), 0.5, 1.0)
    moving = (order < len(intervals)) & (curvatures < 0.0)
    gradients, slope_gradients = (out.full().T for out in functions.probe_gradient(*probes.inputs))
    return Peaks(
        probes=probes,
        times=probes.starts + probes.shares * probes.step,
        values=values,
        is_peak=order < len(values) - len(nodes),
        measure=np.concatenate([np.zeros(len(values) - len(nodes)), trapezoid / (n * outputs.shape[1])]),
        inverse_curvatures=np.where(moving, 1.0 / np.where(moving, curvatures, 1.0), 0.0),
        gradients=gradients,
        slope_gradients=slope_gradients,
    )


def probe(functions: IntervalFunctions, probes: Probes) -> tuple[np.ndarray, ...]:
    """Outputs at the probes and their first and second time derivatives, shapes (n,)."""
    y, *rest = probes.inputs
    return tuple(out.full().ravel() for out in functions.probe(y, probes.ddu.T, *rest))


def _roots(
    functions: IntervalFunctions, place: Place, intervals: np.ndarray, components: np.ndarray, slopes: np.ndarray
) -> np.ndarray:
    """Shares of the intervals at which the slope vanishes: Newton's steps, or halves where these leave the bracket."""
    low, high = np.zeros(len(intervals)), np.ones(len(intervals))
    at_low, at_high = slopes[intervals, components], slopes[intervals + 1, components]
    small = 1e-14 * np.abs(slopes).max(axis=0)[components]
    shares = at_low / (at_low - at_high)
    for _ in range(ROOT_ITERATIONS if len(intervals) else 0):
        probes = place(intervals, components, shares)
        _, slope, curvature = probe(functions, probes)
        if np.all((np.abs(slope) <= small) | (high - low < 1e-15)):
            break
        low, high = np.where(slope > 0.0, shares, low), np.where(slope > 0.0, high, shares)
        step = slope / np.where(curvature < 0.0, curvature * probes.step, -np.inf)
        newton = shares - np.where(curvature < 0.0, step, np.inf)
        shares = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
    return shares
