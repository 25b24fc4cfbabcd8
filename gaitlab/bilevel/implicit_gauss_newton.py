"""Gauss-Newton on the weights, with the lower level solved at every step.

The lower level's solution is differentiated by the implicit function theorem; steps are damped (Levenberg-Marquardt;
Nocedal and Wright 2006, sec. 10.3) and stay on the simplex by solving the small subproblem as nonnegative least
squares (Lawson and Hanson 1974, ch. 23).
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import nnls

from ..errors import ProblemError
from ..nlp.sparse_solution import Status
from .problem import LowerLevel, Response
from .result import WeightEstimate
from .uncertainty import weight_uncertainty

Progress = Callable[[int, float], None]


@dataclass(frozen=True, kw_only=True)
class ImplicitGaussNewton:
    """Settings of the method."""

    tol_step: float = 1e-6
    """Converged when no weight moves by more."""
    tol_decrease: float = 1e-9
    """Converged when the loss falls by less, relatively."""
    max_iter: int = 40
    damping: float = 1e-3
    """First Levenberg-Marquardt factor, relative to the diagonal of J'J."""
    max_damping: float = 1e6

    def solve(
        self, lower: LowerLevel, theta: np.ndarray, response: Response, progress: Progress | None = None
    ) -> WeightEstimate:
        """Improve weights on the simplex, shape (n_theta,), whose lower-level response is known.

        `progress(iteration, rms)` may raise `errors.Cancelled`. Raises `errors.ProblemError` where theta is not on
        the simplex.
        """
        if theta.shape != (lower.n_theta,) or np.any(theta < 0.0) or abs(theta.sum() - 1.0) > 1e-9:
            raise ProblemError(f"theta must be {lower.n_theta} weights >= 0 with sum 1, got {theta}")
        return _Search(self, lower, _State(theta, response), progress).run()


@dataclass
class _State:
    theta: np.ndarray
    response: Response

    @property
    def loss(self) -> float:
        return 0.5 * float(self.response.residual @ self.response.residual)


@dataclass
class _Search:
    method: ImplicitGaussNewton
    lower: LowerLevel
    state: _State
    progress: Progress | None
    damping: float = field(init=False)
    lower_iterations: int = 0

    def __post_init__(self) -> None:
        self.damping = self.method.damping

    def run(self) -> WeightEstimate:
        reason, iteration = "iteration limit reached", 0
        for iteration in range(self.method.max_iter):
            if self.progress is not None:
                self.progress(iteration, float(np.sqrt(np.mean(self.state.response.residual**2))))
            jacobian = self.state.response.jacobian()
            outcome = self._step(jacobian)
            if outcome is not None:
                reason = outcome
                break
        return self._estimate(reason, iteration + 1)

    def _step(self, jacobian: np.ndarray) -> str | None:
        """Move to better weights; the reason to stop, or None to go on."""
        while self.damping <= self.method.max_damping:
            theta = self._subproblem(jacobian)
            step = theta - self.state.theta
            if np.max(np.abs(step)) <= self.method.tol_step:
                return "converged: the weights do not move"
            response = self.lower.respond(theta, self.state.response.predict(step))
            self.lower_iterations += response.solution.iterations
            trial = _State(theta, response)
            if response.solution.status is Status.SOLVED and trial.loss < self.state.loss:
                decrease = (self.state.loss - trial.loss) / self.state.loss
                self.state, self.damping = trial, max(self.damping / 5.0, 1e-9)
                return "converged: the fit does not improve" if decrease <= self.method.tol_decrease else None
            self.damping *= 8.0
        return "converged: no smaller step improves the fit"

    def _subproblem(self, jacobian: np.ndarray) -> np.ndarray:
        """Minimise |r + J (t - theta)|^2 + damping |D (t - theta)|^2 over the simplex."""
        theta, residual = self.state.theta, self.state.response.residual
        scale = np.sqrt(self.damping * (np.sum(jacobian**2, axis=0) + 1e-12))
        anchor = 1e4 * float(np.max(np.linalg.norm(jacobian, axis=0), initial=1e-6))
        A = np.vstack([jacobian, np.diag(scale), np.full((1, len(theta)), anchor)])
        b = np.concatenate([jacobian @ theta - residual, scale * theta, [anchor]])
        t, _ = nnls(A, b)
        return t / t.sum()

    def _estimate(self, reason: str, iterations: int) -> WeightEstimate:
        response = self.state.response
        jacobian = response.jacobian()
        uncertainty = weight_uncertainty(jacobian, response.residual_by_time())
        return WeightEstimate(
            theta=self.state.theta,
            response=response,
            covariance=uncertainty.covariance,
            identifiable=uncertainty.identifiable,
            condition=uncertainty.condition,
            converged=reason.startswith("converged"),
            reason=reason,
            iterations=iterations,
            lower_iterations=self.lower_iterations,
        )
