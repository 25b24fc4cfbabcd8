"""Filter line search of Wächter and Biegler (2006), section 2.3, without second-order correction."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .sparse_problem import Values

Trial = tuple[np.ndarray, np.ndarray, Values]

GAMMA = 1e-5
"""Margin of the filter envelope (their gamma_theta, gamma_phi)."""
ETA = 1e-4
"""Armijo factor (their eta_phi; 1e-8 there)."""
LARGEST = 1e4
"""Violation that is allowed in units of the first one, or of one (their theta_max)."""
SHORTEST = 1e-4
"""Steps below this fraction call for another regularisation instead."""


class Merit:
    """Constraint violation (1-norm) and barrier function of one point."""

    def __init__(self, values: Values, s: np.ndarray, mu: float) -> None:
        self.mu = mu
        self.violation = float(np.abs(values.g).sum() + np.abs(values.c - s).sum())
        self.barrier = float(values.f - mu * np.sum(np.log(s)))


@dataclass
class Filter:
    """Pairs (violation, barrier) that new points must improve on."""

    largest: float = np.inf
    """No point with a larger violation is accepted (their theta_max)."""
    entries: list[tuple[float, float]] = field(default_factory=list[tuple[float, float]])

    def accepts(self, merit: Merit, noise: float = 0.0) -> bool:
        """Whether no stored pair dominates the point; barrier functions differ if by more than noise."""
        return merit.violation <= self.largest and all(
            merit.violation <= (1.0 - GAMMA) * violation or merit.barrier - noise <= barrier - GAMMA * violation
            for violation, barrier in self.entries
        )

    def add(self, merit: Merit) -> None:
        """Store a pair, forgetting those that it dominates."""
        kept = [e for e in self.entries if e[0] < merit.violation or e[1] < merit.barrier]
        self.entries = [*kept, (merit.violation, merit.barrier)]


def backtrack(
    search_filter: Filter, start: Merit, slope: float, trial: Callable[[float], Trial], alpha: float
) -> tuple[float, np.ndarray, np.ndarray, Values] | None:
    """Halve alpha until the filter accepts trial(alpha) -> (w, s, values); None where the step becomes too short.

    `slope` is the derivative of the barrier function along the step. Returns (alpha, w, s, values) of the accepted
    point, w of shape (n_w,), s of shape (n_c,).
    """
    shortest = SHORTEST * alpha
    # Rounding: near the solution the barrier function cannot be compared below this (Wächter and Biegler, sec. 3.10).
    noise = 10.0 * np.finfo(float).eps * max(1.0, abs(start.barrier))
    while alpha >= shortest:
        w, s, values = trial(alpha)
        if np.isfinite(values.f) and np.all(np.isfinite(values.g)) and np.all(np.isfinite(values.c)):
            new = Merit(values, s, start.mu)
            if search_filter.accepts(new, noise):
                descends = slope < 0.0 and alpha * (-slope) ** 2.3 > start.violation**1.1
                if descends and new.barrier - noise <= start.barrier + ETA * alpha * slope:
                    return alpha, w, s, values
                if not descends and _improves(new, start, noise):
                    search_filter.add(start)
                    return alpha, w, s, values
        alpha /= 2.0
    return None


def _improves(new: Merit, start: Merit, noise: float) -> bool:
    less_violation = new.violation <= (1.0 - GAMMA) * start.violation
    return less_violation or new.barrier - noise <= start.barrier - GAMMA * start.violation
