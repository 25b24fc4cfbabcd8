r"""Performance profiles of methods over a set of problems (Dolan and Moré, Math. Program. 91, 2002).

.. math:: r_{p,s} = t_{p,s} / \min_{s'} t_{p,s'}, \qquad \rho_s(\tau) = |\{p : r_{p,s} \le \tau\}| / |P|
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .mpcc_collection import Row


@dataclass(frozen=True, kw_only=True)
class Profile:
    """Steps of rho for one method."""

    method: str
    ratios: np.ndarray
    """Increasing ratios tau at which rho steps, shape (n_solved,)."""
    parts: np.ndarray
    """rho after each step, shape (n_solved,)."""


def performance_profiles(rows: Sequence[Row], measure: Callable[[Row], float]) -> list[Profile]:
    """Profiles of all methods; a problem counts as solved where the best objective of all methods is reached."""
    problems = sorted({row.problem for row in rows})
    methods = list(dict.fromkeys(row.method for row in rows))
    costs = np.full((len(problems), len(methods)), np.inf)
    for i, problem in enumerate(problems):
        solved = [row for row in rows if row.problem == problem and row.solved]
        best = min((row.sense * row.objective for row in solved), default=np.inf)
        for row in solved:
            if row.reaches(row.sense * best):
                # A start at the solution takes no iteration; ratios need a positive cost.
                costs[i, methods.index(row.method)] = max(measure(row), 1e-9)
    least = costs.min(axis=1, initial=np.inf)
    profiles: list[Profile] = []
    for k, method in enumerate(methods):
        ratios = np.sort((costs[:, k] / least)[np.isfinite(costs[:, k])])
        parts = np.arange(1, ratios.size + 1) / max(len(problems), 1)
        profiles.append(Profile(method=method, ratios=ratios, parts=parts))
    return profiles
