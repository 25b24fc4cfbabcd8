"""Sampled solutions of optimal control problems."""

from dataclasses import dataclass, field

import numpy as np

from .constraint import Bounds
from .problem import MultiStageProblem
from .stage import Stage


@dataclass(frozen=True, kw_only=True)
class StageTrajectory:
    """States and controls of one stage."""

    fraction: np.ndarray
    """Times as fractions of the duration, increasing from 0 to 1, shape (n,)."""
    duration: float
    """[s]"""
    x: np.ndarray
    """States, shape (n, n_x)."""
    u: np.ndarray
    """Controls; where they jump, from the right (at the end from the left); shape (n, n_u)."""

    @property
    def t(self) -> np.ndarray:
        """Times since the stage began [s], shape (n,)."""
        return self.duration * self.fraction

    def state_at(self, fraction: np.ndarray) -> np.ndarray:
        """States at fractions of the duration, shape (m,), linear between samples; result (m, n_x)."""
        return np.column_stack([np.interp(fraction, self.fraction, column) for column in self.x.T])

    def control_at(self, fraction: np.ndarray) -> np.ndarray:
        """Controls of the last sample not later than each fraction, shape (m,); result (m, n_u)."""
        last = np.searchsorted(self.fraction, fraction + 1e-12, side="right") - 1
        return self.u[np.clip(last, 0, len(self.fraction) - 1)]


@dataclass(frozen=True, kw_only=True)
class Trajectory:
    """States and controls of all stages, and the control values."""

    stages: tuple[StageTrajectory, ...]
    q: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Control values, shape (n_q,)."""

    @property
    def duration(self) -> float:
        """Of all stages [s]."""
        return float(sum(stage.duration for stage in self.stages))


def straight_line(problem: MultiStageProblem, q: np.ndarray, n: int = 11) -> Trajectory:
    """Start for a solver: states straight from start to end bounds, controls nearest to zero, q of shape (n_q,)."""
    return Trajectory(stages=tuple(_straight(stage, n) for stage in problem.stages), q=np.asarray(q, dtype=float))


def _straight(stage: Stage, n: int) -> StageTrajectory:
    bounds = [stage.bounds_at(start=True, end=False), stage.bounds_at(start=False, end=True)]
    # Where one end is free, the state stays what it is at the other.
    free = [~np.isfinite(each.lower) & ~np.isfinite(each.upper) for each in bounds]
    first, last = (_middle(each) for each in bounds)
    first, last = np.where(free[0], last, first), np.where(free[1], first, last)
    fraction = np.linspace(0.0, 1.0, n)
    x = first + fraction[:, None] * (last - first)
    u = np.clip(np.zeros((n, stage.n_u)), stage.control_bounds.lower, stage.control_bounds.upper)
    return StageTrajectory(fraction=fraction, duration=1.0, x=x, u=u)


def _middle(bounds: Bounds) -> np.ndarray:
    # The middle of an interval; of a half-infinite one its end; zero where nothing is known.
    lower = np.where(np.isfinite(bounds.lower), bounds.lower, np.minimum(bounds.upper, 0.0))
    upper = np.where(np.isfinite(bounds.upper), bounds.upper, np.maximum(bounds.lower, 0.0))
    return 0.5 * (lower + upper)
