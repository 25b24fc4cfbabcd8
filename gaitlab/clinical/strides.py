"""All strides of one side over several trials: which differ and why, which one stands for them, how alike they are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .spatiotemporal import Spatiotemporal

FEWEST = 5
"""Strides of one side below which none is called an outlier: the spread of so few is not known."""
MODIFIED_Z = 3.5
"""Limit of 0.6745 |x - median| / MAD (Iglewicz & Hoaglin, How to detect and handle outliers, 1993)."""
CURVE_FLOOR = 3.0
"""Differences up to this are never flagged, however alike the others are [deg]."""
RELATIVE_FLOOR = 0.1
"""The same for distances and times, part of their median."""
_TESTED = {
    "stride_length_m": ("stride length", "m"),
    "stride_time_s": ("stride time", "s"),
    "speed_m_per_s": ("speed", "m/s"),
}


@dataclass(frozen=True, kw_only=True)
class Consistency:
    """How alike the strides are in one curve."""

    sd: float
    """Root mean square over the cycle of the standard deviation between strides [deg]."""
    cmc: float | None
    """Coefficient of multiple correlation, 1 for equal strides; None where a curve has hardly any range of its own."""
    n_strides: int


def outlier_reasons(
    curves: Mapping[str, Sequence[np.ndarray]], distances: Sequence[Spatiotemporal]
) -> list[tuple[str, ...]]:
    """Why each stride differs from the others, in words; empty tuples for those that do not.

    A stride is flagged in a curve when its root mean square difference from the median stride is larger than the
    median of these differences by 3.5 robust standard deviations and by 3 deg; in a distance or time when it is 3.5
    robust standard deviations and 10 % away from the median. Nothing is removed.

    Args:
        curves: Curve name to one array [deg] of shape (101,) per stride, NaN where unknown.
        distances: Distances and times of the same strides.
    """
    n = len(distances)
    reasons: list[list[str]] = [[] for _ in range(n)]
    if n < FEWEST:
        return [()] * n
    for name, values in curves.items():
        for index, distance, limit in _far_curves(values):
            words = name.replace("_", " ")
            reasons[index].append(f"{words} is {distance:.1f} deg rms from the median stride (limit {limit:.1f})")
    for field, (words, unit) in _TESTED.items():
        for index, value, median in _far_numbers([getattr(cycle, field) for cycle in distances]):
            reasons[index].append(f"{words} {value:.2f} {unit} (median {median:.2f} {unit})")
    return [tuple(found) for found in reasons]


def _far_curves(values: Sequence[np.ndarray]) -> list[tuple[int, float, float]]:
    whole = [index for index, curve in enumerate(values) if np.all(np.isfinite(curve))]
    if len(whole) < FEWEST:
        return []
    stacked = np.array([values[index] for index in whole])  # (n_strides, 101)
    distances = np.sqrt(np.mean(np.square(stacked - np.median(stacked, axis=0)), axis=1))
    middle = float(np.median(distances))
    limit = middle + max(MODIFIED_Z * _robust_sd(distances), CURVE_FLOOR)
    far = np.flatnonzero(distances > limit)
    return [(whole[int(k)], float(distances[k]), limit) for k in far]


def _far_numbers(values: Sequence[float | None]) -> list[tuple[int, float, float]]:
    known = [(index, value) for index, value in enumerate(values) if value is not None]
    if len(known) < FEWEST:
        return []
    numbers = np.array([value for _, value in known])
    middle = float(np.median(numbers))
    limit = max(MODIFIED_Z * _robust_sd(numbers), RELATIVE_FLOOR * abs(middle))
    return [(index, value, middle) for index, value in known if abs(value - middle) > limit]


def _robust_sd(values: np.ndarray) -> float:
    return float(np.median(np.abs(values - np.median(values)))) / 0.6745


def representative(curves: Mapping[str, Sequence[np.ndarray]], flagged: Sequence[bool]) -> int | None:
    """Index of the stride closest to the median stride over all curves; None if no stride is complete.

    Distances in each curve are divided by the mean spread of that curve, so that no curve outweighs the others.
    Flagged strides are taken only when there is no other.

    Args:
        curves: Curve name to one array [deg] of shape (101,) per stride, NaN where unknown.
        flagged: Whether each stride is an outlier.
    """
    whole = [k for k in range(len(flagged)) if all(np.all(np.isfinite(values[k])) for values in curves.values())]
    chosen = [k for k in whole if not flagged[k]] or whole
    if not chosen or not curves:
        return None
    total = np.zeros(len(chosen))
    for values in curves.values():
        stacked = np.array([values[k] for k in chosen])
        distances = np.sqrt(np.mean(np.square(stacked - np.median(stacked, axis=0)), axis=1))
        total += distances / max(float(distances.mean()), np.finfo(float).tiny)
    return chosen[int(np.argmin(total))]


def consistency(curves: Sequence[np.ndarray]) -> Consistency | None:
    """Spread of the complete strides of one curve [deg], shape (101,) each; None with fewer than two.

    The coefficient of multiple correlation is that of Kadaba et al. (J Orthop Res 7:849, 1989, within a day):
    CMC^2 = 1 - [sum (Y_ij - Y_j)^2 / (T (N - 1))] / [sum (Y_ij - Y)^2 / (N T - 1)], strides i, samples j.
    """
    whole = np.array([curve for curve in curves if np.all(np.isfinite(curve))])
    if len(whole) < 2:
        return None
    n, samples = whole.shape
    within = float(np.sum(np.square(whole - whole.mean(axis=0)))) / (samples * (n - 1))
    total = float(np.sum(np.square(whole - whole.mean()))) / (n * samples - 1)
    ratio = within / total if total > 0.0 else 1.0
    return Consistency(sd=float(np.sqrt(within)), cmc=float(np.sqrt(1.0 - ratio)) if ratio < 1.0 else None, n_strides=n)
