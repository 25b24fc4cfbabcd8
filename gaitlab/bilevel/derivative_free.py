"""Derivative-free Gauss-Newton on the parameters: DFO-LS (Cartis, Fiala, Marteau, Roberts, ACM TOMS 45, 2019).

The class of method of Hatz (2014), section 7.2 (POUNDERS): each residual is interpolated by a linear model over a few
points. The lower level is a black box. Weights on a simplex lose their last entry, which is one minus the others.
"""

import logging
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import dfols
import numpy as np

from ..errors import NotConverged
from .inverse_finish import Stop
from .inverse_problem import InverseProblem
from .inverse_result import InverseResult, InverseStatus
from .lower_level import LowerSettings
from .reduced_objective import ReducedObjective, search_parameters


@dataclass(frozen=True, kw_only=True)
class DerivativeFree:
    """Settings of the method."""

    lower: LowerSettings = field(default_factory=LowerSettings)
    first_radius: float = 0.1
    """Trust region at the start, relative to max(|p|, 1) of the scaled parameters."""
    last_radius: float = 1e-8
    """Converged when the trust region is smaller."""
    max_evaluations: int = 500
    seconds: float = 600.0
    """Wall time after which the search stops [s]."""

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from w0, shape (n_w,), and p0, shape (n_p,).

        Raises:
            ProblemError: p0 has a wrong shape or is not finite.
        """
        return search_parameters(
            problem, self.lower, (w0, p0), lambda objective, began: _Search(self, objective, began).run()
        )


class _Search:
    """Scaled coordinates x of the free parameters, without the last weight of a simplex."""

    def __init__(self, method: DerivativeFree, objective: ReducedObjective, began: float) -> None:
        self._method, self._objective, self._began = method, objective, began
        allowed = objective.allowed
        self._kept = np.ones(allowed.n_y, dtype=bool)
        if allowed.simplex.any():
            self._kept[np.flatnonzero(allowed.simplex)[-1]] = False
        y = objective.best.p[allowed.index]
        self._total = float(y[allowed.simplex].sum())
        self._size = np.maximum(np.abs(y[self._kept]), 1e-2)
        self._x0 = y[self._kept] / self._size

    def run(self) -> Stop:
        allowed = self._objective.allowed
        bounds = allowed.lower[self._kept] / self._size, allowed.upper[self._kept] / self._size
        box = np.clip(bounds[0], -1e20, None), np.clip(bounds[1], None, 1e20)
        options: dict[str, Any] = {"bounds": box} if self._kept.all() else {"projections": [_box(box), self._simplex]}
        logging.getLogger("dfols").setLevel(logging.CRITICAL)
        try:
            with warnings.catch_warnings():
                # Bounds nearer than the trust region make DFO-LS shrink it and say so.
                warnings.simplefilter("ignore")
                found = dfols.solve(
                    self._residual, self._x0, rhobeg=self._method.first_radius, rhoend=self._method.last_radius,
                    maxfun=self._method.max_evaluations, **options,
                )  # fmt: skip
        except NotConverged as error:
            return self._stop(InverseStatus.TIME_LIMIT, str(error))
        if found.flag in (found.EXIT_SUCCESS, found.EXIT_SLOW_WARNING):
            return self._stop(InverseStatus.CONVERGED, f"the trust region is small: {found.msg}")
        if found.flag == found.EXIT_MAXFUN_WARNING:
            return self._stop(InverseStatus.ITERATION_LIMIT, found.msg)
        return self._stop(InverseStatus.STALLED, found.msg)

    def _stop(self, status: InverseStatus, reason: str) -> Stop:
        return Stop(status=status, reason=reason, iterations=self._objective.evaluations)

    def _residual(self, x: np.ndarray) -> np.ndarray:
        if time.perf_counter() - self._began > self._method.seconds:
            raise NotConverged(f"no end within {self._method.seconds:g} s")
        response = self._objective.respond(self._parameters(x))
        if response is None:
            # A large, finite value sends the trust region back.
            return 1e3 * (1.0 + np.abs(self._objective.residual(self._objective.best)))
        return self._objective.residual(response)

    def _parameters(self, x: np.ndarray) -> np.ndarray:
        allowed = self._objective.allowed
        y = np.zeros(allowed.n_y)
        y[self._kept] = x * self._size
        y[~self._kept] = self._total - y[self._kept & allowed.simplex].sum()
        return np.clip(y, allowed.lower, allowed.upper)

    def _simplex(self, x: np.ndarray) -> np.ndarray:
        """Nearest x whose missing weight is within its bounds."""
        allowed = self._objective.allowed
        normal = np.where(allowed.simplex, 1.0, 0.0)[self._kept] * self._size
        total = float(normal @ x)
        last = ~self._kept
        nearest = float(np.clip(total, self._total - allowed.upper[last][0], self._total - allowed.lower[last][0]))
        return x + normal * (nearest - total) / float(normal @ normal)


def _box(bounds: tuple[np.ndarray, np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
    return lambda x: np.clip(x, *bounds)
