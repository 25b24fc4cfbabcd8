"""Several starts of a local method, best certified end kept."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..mpcc import MPCC
from ..mpcc_solution import MPCCSolution
from .method import NO_PARAMETERS, MPCCMethod


@dataclass(frozen=True, kw_only=True)
class MultiStart:
    """Runs a method from the given start and from random ones around it."""

    method: MPCCMethod
    n_starts: int = 5
    seed: int = 0

    def solve(self, problem: MPCC, w0: np.ndarray, p: np.ndarray = NO_PARAMETERS) -> MPCCSolution:
        """Best solution over the starts; w0 has shape (n_w,), p shape (n_p,)."""
        prepared = self.method.prepare(problem)
        return best([prepared.solve(w, p) for w in starts(problem, w0, self.n_starts, self.seed)])


def starts(problem: MPCC, w0: np.ndarray, n_starts: int, seed: int = 0) -> list[np.ndarray]:
    """The start w0, shape (n_w,), and random ones: uniform between two bounds, else spread around w0."""
    random = np.random.default_rng(seed)
    boxed = np.isfinite(problem.lbw) & np.isfinite(problem.ubw)
    found = [w0]
    for _ in range(n_starts - 1):
        spread = 10.0 ** random.uniform(-1.0, 1.0) * np.maximum(np.abs(w0), 1.0)
        around = w0 + spread * random.standard_normal(w0.size)
        inside = random.uniform(np.where(boxed, problem.lbw, 0.0), np.where(boxed, problem.ubw, 1.0))
        found.append(np.clip(np.where(boxed, inside, around), problem.lbw, problem.ubw))
    return found


def best(solutions: Sequence[MPCCSolution]) -> MPCCSolution:
    """The lowest of the stationary points; without one the lowest feasible, else the least infeasible."""

    def rank(solution: MPCCSolution) -> tuple[int, float]:
        if solution.is_stationary():
            return 0, solution.f
        if solution.is_feasible():
            return 1, solution.f
        miss = max(solution.violation, solution.complementarity)
        return 2, miss if np.isfinite(miss) else np.inf

    return min(solutions, key=rank)
