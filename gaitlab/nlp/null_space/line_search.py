"""Inner iterations: steps along one direction that double while they help, then halve."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

DOUBLINGS = 120
"""Steps that still grow after this many have no bottom: 2^120 times the first one."""


@dataclass(frozen=True, kw_only=True)
class StepLengths:
    """Settings of the inner iterations."""

    first: float = 1e-6
    """initial_step_length of Table 1."""
    multiplier: float = 2.0
    """step_multiplier of Table 1."""


def doubling_search(
    value: Callable[[np.ndarray], float], x: np.ndarray, direction: np.ndarray, steps: StepLengths
) -> np.ndarray:
    """Point on the ray from x, both of shape (n,), where `value` is least; x itself if no step helps.

    The step grows until the value does, too, as in Algorithms 1 to 3 of the source, which stop there with up to half
    of the way left; here it shrinks again, forwards or backwards, down to the first step. A value that is not a number,
    or infinite, counts as growing.
    """
    best, step = value(x), steps.first
    for _ in range(DOUBLINGS):
        trial = x + step * direction
        at_trial = value(trial)
        if not at_trial < best:
            break
        x, best, step = trial, at_trial, step * steps.multiplier
    while step > steps.first:
        step /= steps.multiplier
        for sign in (1.0, -1.0):
            trial = x + sign * step * direction
            at_trial = value(trial)
            if at_trial < best:
                x, best = trial, at_trial
                break
    return x
