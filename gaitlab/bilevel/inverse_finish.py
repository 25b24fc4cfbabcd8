"""Turns the last response of a method that solves the lower level into a result."""

import time
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..nlp.problem import NLP
from ..nlp.solution import NLPSolution
from .inverse_problem import InverseProblem
from .inverse_result import InverseResult, InverseStatus
from .lower_level import LowerLevel, Response
from .parameter_uncertainty import parameter_uncertainty


@dataclass(frozen=True, kw_only=True)
class Stop:
    """Why a method stopped."""

    status: InverseStatus
    reason: str
    iterations: int


def finish(lower: LowerLevel, response: Response, stop: Stop, began: float) -> InverseResult:
    """Result of a response, with the uncertainty of its parameters; `began` is `time.perf_counter()` at the start."""
    problem, slopes = lower.problem, lower.slopes(response) if response.solved else None
    covariance = identifiable = None
    reason = stop.reason
    if slopes is not None:
        active = np.minimum(np.abs(response.upper - problem.lbu), np.abs(problem.ubu - response.upper)) <= 1e-6
        found = parameter_uncertainty(problem, response.p, slopes.residual, slopes.upper[active])
        covariance, identifiable = found.covariance, found.identifiable
        lost = [problem.parameter_name(int(i)) for i in np.flatnonzero(~identifiable)]
        if lost:
            reason += f"; the measurements do not tell {', '.join(lost)}"
    solution = response.solution
    return InverseResult(
        p=response.p,
        w=solution.w,
        lam_w=solution.lam_w,
        lam_g=solution.lam_g,
        objective=response.objective,
        residuals=solution.residuals,
        complementarity=lower_complementarity(problem.nlp, solution, response.p),
        status=stop.status,
        reason=reason,
        iterations=stop.iterations,
        lower_iterations=lower.iterations,
        seconds=time.perf_counter() - began,
        covariance=covariance,
        identifiable=identifiable,
    )


def lower_complementarity(nlp: NLP, solution: NLPSolution, p: np.ndarray) -> float:
    """max_i min(slack_i, |multiplier_i|) over bounds and inequalities, at parameters p, shape (n_p,)."""
    g = np.asarray(ca.Function("g", [nlp.w, nlp.p], [nlp.g])(solution.w, p)).ravel()
    c, lam = np.concatenate([g, solution.w]), np.concatenate([solution.lam_g, solution.lam_w])
    lower, upper = np.concatenate([nlp.lbg, nlp.lbw]), np.concatenate([nlp.ubg, nlp.ubw])
    slack = np.where(lam > 0.0, np.abs(upper - c), np.abs(c - lower))
    return float(np.max(np.where(lower == upper, 0.0, np.minimum(slack, np.abs(lam))), initial=0.0))


def first_response(lower: LowerLevel, w0: np.ndarray, p0: np.ndarray, began: float) -> Response | InverseResult:
    """Response from w0, shape (n_w,), and p0, shape (n_p,), or the result that says why there is none.

    Raises:
        ProblemError: w0 or p0 has a wrong shape or is not finite.
    """
    p, w0 = lower.problem.start(p0), lower.problem.lower_start(w0)
    invalid = lower.invalid(w0, p)
    response = lower.start(w0, p)
    if response.solved:
        return response
    stop = unsolved(lower, response, 0)
    if invalid is not None:
        stop = Stop(status=InverseStatus.INVALID_NUMBER, reason=invalid, iterations=0)
    return finish(lower, response, stop, began)


def unsolved(lower: LowerLevel, response: Response, iterations: int) -> Stop:
    """Stop because the lower level has no solution here."""
    reason = lower.failure(response)
    return Stop(status=InverseStatus.LOWER_LEVEL_FAILED, reason=reason, iterations=iterations)


def largest_upper_violation(problem: InverseProblem, upper: np.ndarray) -> tuple[float, str]:
    """Largest violation of the upper-level constraints with values `upper`, shape (n_u,), and a sentence on it."""
    miss = np.maximum(np.maximum(problem.lbu - upper, upper - problem.ubu), 0.0)
    if not miss.size:
        return 0.0, ""
    i = int(np.argmax(miss))
    bounds = f"[{problem.lbu[i]:.6g}, {problem.ubu[i]:.6g}]"
    return float(miss[i]), f"upper-level constraint {i} = {upper[i]:.6g} misses its bounds {bounds} by {miss[i]:.3g}"
