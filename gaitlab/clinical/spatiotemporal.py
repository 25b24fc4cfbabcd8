"""Distances and times of gait, per cycle: speed, cadence, lengths, width, phases.

Definitions: stride length is the way of one foot between its strikes, on the ground plane; the direction of progression
is that way. Step length and time belong to the foot that lands: from the opposite foot's strike to the side's own next
strike. Step width is the distance of the opposite foot's strike from the line through the side's two strikes
(Perry & Burnfield, Gait Analysis, 2010, ch. 1).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence

import msgspec
import numpy as np

from ..mocap.cycle import Cycle
from ..mocap.recording import Side

Reduction = Callable[[list[float]], float | None]
GRAVITY = 9.81  # [m/s^2]
OPPOSITE: Mapping[Side, Side] = {"left": "right", "right": "left"}


class Spatiotemporal(msgspec.Struct, frozen=True, kw_only=True):
    """One side; percent are of the gait cycle, which starts at the side's foot strike."""

    speed_m_per_s: float | None
    cadence_steps_per_min: float | None
    stride_length_m: float | None
    step_length_m: float | None
    step_width_m: float | None
    stride_time_s: float | None
    step_time_s: float | None
    foot_off_percent: float | None
    opposite_foot_off_percent: float | None
    opposite_foot_strike_percent: float | None
    single_support_percent: float | None
    double_support_percent: float | None
    stance_percent: float | None
    swing_percent: float | None


class NormalisedSpatiotemporal(msgspec.Struct, frozen=True, kw_only=True):
    """Dimensionless with leg length l, gravity g: v / sqrt(g l), f / sqrt(g / l), x / l, t / sqrt(l / g) (Hof 1996)."""

    speed: float | None
    cadence: float | None
    stride_length: float | None
    step_length: float | None
    step_width: float | None
    stride_time: float | None = None
    step_time: float | None = None


def cycle_spatiotemporal(cycle: Cycle, feet: Mapping[Side, np.ndarray], rate: float) -> Spatiotemporal:
    """Spatiotemporal parameters of one cycle.

    Args:
        cycle: Times [s] from the first row of `feet`.
        feet: Position of one point per foot, for instance the heel, laboratory frame, z up [m], shape (n_frames, 3).
        rate: Rows per second [Hz].
    """
    own, other = feet[cycle.side], feet[OPPOSITE[cycle.side]]
    first, last = (_position_at(own, rate, time) for time in (cycle.start, cycle.end))
    between = _position_at(other, rate, cycle.opposite_foot_strike)
    stride = last - first
    length = float(np.linalg.norm(stride))
    forward = stride / length if length > 0.0 else np.full(2, np.nan)
    step = last - between
    duration = cycle.end - cycle.start
    percent = _Percent(cycle.start, duration)
    foot_off, off, strike = (
        percent(time) for time in (cycle.foot_off, cycle.opposite_foot_off, cycle.opposite_foot_strike)
    )
    single = _difference(strike, off)
    return Spatiotemporal(
        speed_m_per_s=_finite(length / duration),
        cadence_steps_per_min=120.0 / duration,
        stride_length_m=_finite(length),
        step_length_m=_finite(float(step @ forward)),
        step_width_m=_finite(abs(float(forward[0] * step[1] - forward[1] * step[0]))),
        stride_time_s=duration,
        step_time_s=_difference(cycle.end, cycle.opposite_foot_strike),
        foot_off_percent=foot_off,
        opposite_foot_off_percent=off,
        opposite_foot_strike_percent=strike,
        single_support_percent=single,
        double_support_percent=_difference(foot_off, single),
        stance_percent=foot_off,
        swing_percent=_difference(100.0, foot_off),
    )


def mean(cycles: Sequence[Spatiotemporal]) -> Spatiotemporal:
    """Mean of each quantity over the cycles that have it."""
    return _combine(cycles, lambda values: float(np.mean(values)))


def standard_deviation(cycles: Sequence[Spatiotemporal]) -> Spatiotemporal:
    """Sample standard deviation of each quantity; null with fewer than two values."""
    return _combine(cycles, lambda values: float(np.std(values, ddof=1)) if len(values) > 1 else None)


def normalise(values: Spatiotemporal, leg_length: float | None) -> NormalisedSpatiotemporal:
    """Divide by leg length [m] and gravity; all null without a leg length."""
    if leg_length is None:
        return NormalisedSpatiotemporal(**dict.fromkeys(NormalisedSpatiotemporal.__struct_fields__))
    per_second = None if values.cadence_steps_per_min is None else values.cadence_steps_per_min / 60.0
    return NormalisedSpatiotemporal(
        speed=_over(values.speed_m_per_s, np.sqrt(GRAVITY * leg_length)),
        cadence=_over(per_second, np.sqrt(GRAVITY / leg_length)),
        stride_length=_over(values.stride_length_m, leg_length),
        step_length=_over(values.step_length_m, leg_length),
        step_width=_over(values.step_width_m, leg_length),
        stride_time=_over(values.stride_time_s, np.sqrt(leg_length / GRAVITY)),
        step_time=_over(values.step_time_s, np.sqrt(leg_length / GRAVITY)),
    )


class _Percent:
    """Time as percent of one cycle."""

    def __init__(self, start: float, duration: float) -> None:
        self._start, self._duration = start, duration

    def __call__(self, time: float | None) -> float | None:
        return None if time is None else 100.0 * (time - self._start) / self._duration


def _position_at(points: np.ndarray, rate: float, time: float | None) -> np.ndarray:
    # Linear between frames, on the ground plane; NaN where unknown.
    if time is None:
        return np.full(2, np.nan)
    frames = np.arange(len(points))
    return np.array([np.interp(time * rate, frames, points[:, axis], np.nan, np.nan) for axis in (0, 1)])


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _difference(a: float | None, b: float | None) -> float | None:
    return None if a is None or b is None else a - b


def _over(value: float | None, divisor: float) -> float | None:
    return None if value is None else float(value / divisor)


def _combine(cycles: Sequence[Spatiotemporal], reduce: Reduction) -> Spatiotemporal:
    return Spatiotemporal(**{name: _reduce(cycles, name, reduce) for name in Spatiotemporal.__struct_fields__})


def _reduce(cycles: Iterable[Spatiotemporal], name: str, reduce: Reduction) -> float | None:
    values = [value for cycle in cycles if (value := getattr(cycle, name)) is not None]
    return reduce(values) if values else None
