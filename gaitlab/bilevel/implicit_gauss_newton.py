"""Gauss-Newton on the weights, with the lower level solved at every step.

The lower level's solution is differentiated by the implicit function theorem. The misfit of real data is not small,
so the second-order part of the loss is learnt from the changes of the Jacobian (Dennis, Gay and Welsch, ACM TOMS 7,
1981). Steps are damped (Levenberg-Marquardt; Nocedal and Wright 2006, sec. 10.3) and stay on the simplex by solving
the small subproblem as nonnegative least squares (Lawson and Hanson 1974, ch. 23).
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ..errors import ProblemError
from ..nlp.sparse_solution import Status
from .problem import LowerLevel, Response
from .result import WeightEstimate
from .simplex_step import damped_minimiser
from .uncertainty import weight_uncertainty

Progress = Callable[[int, float], None]

UNSOLVED = "the lower level is not solved for neighbouring weights"


@dataclass(frozen=True, kw_only=True)
class ImplicitGaussNewton:
    """Settings of the method."""

    tol_step: float = 1e-5
    """Converged when no weight moves by more."""
    tol_decrease: float = 1e-7
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
    """Weights on the simplex, shape (n_theta,)."""
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
    second_order: np.ndarray = field(init=False)
    """Structured quasi-Newton estimate of what Gauss-Newton leaves out of the Hessian, shape (n_theta, n_theta)."""
    lower_iterations: int = 0

    def __post_init__(self) -> None:
        self.damping = self.method.damping
        self.second_order = np.zeros((self.lower.n_theta, self.lower.n_theta))

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
        solved, growth = True, 8.0
        while self.damping <= self.method.max_damping:
            theta = self._subproblem(jacobian)
            step = theta - self.state.theta
            if np.max(np.abs(step)) <= self.method.tol_step:
                return "converged: the weights do not move" if solved else UNSOLVED
            response = self.lower.respond(theta, self.state.response.predict(step))
            self.lower_iterations += response.solution.iterations
            trial = _State(theta, response)
            solved = response.solution.status is Status.SOLVED
            if solved and trial.loss < self.state.loss:
                decrease = (self.state.loss - trial.loss) / self.state.loss
                self._learn(jacobian, trial, step)
                self.state, self.damping = trial, max(self.damping / 5.0, 1e-9)
                return "converged: the fit does not improve" if decrease <= self.method.tol_decrease else None
            # A damping far too small hardly changes the step: every failure makes for a larger leap.
            self.damping, growth = max(self.damping * growth, self.method.damping), 4.0 * growth
        return "converged: no smaller step improves the fit" if solved else UNSOLVED

    def _subproblem(self, jacobian: np.ndarray) -> np.ndarray:
        """Minimise the damped quadratic model of the loss over the simplex."""
        residual = self.state.response.residual
        return damped_minimiser(self.state.theta, residual, jacobian, self.damping, self.second_order)

    def _learn(self, jacobian: np.ndarray, trial: _State, step: np.ndarray) -> None:
        """Update the second-order part so that it maps the step to the change of J at the new residual."""
        new, residual = trial.response.jacobian(), trial.response.residual
        y = new.T @ residual - jacobian.T @ self.state.response.residual
        change = (new - jacobian).T @ residual
        curvature = float(y @ step)
        if curvature <= 1e-12 * float(np.linalg.norm(y) * np.linalg.norm(step)):
            return
        expected = float(step @ self.second_order @ step)
        if expected != 0.0:
            self.second_order *= min(1.0, abs(float(step @ change) / expected))
        gap = change - self.second_order @ step
        self.second_order += (np.outer(gap, y) + np.outer(y, gap)) / curvature
        self.second_order -= float(gap @ step) / curvature**2 * np.outer(y, y)

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
