"""Solving a transcribed problem: the trajectory, its certificate, and a sentence on how it ended."""

import re
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..nlp.derivatives import differentiate
from ..nlp.diagnosis import blame
from ..nlp.ipopt import Ipopt
from ..nlp.problem import NLP
from ..nlp.solution import NLPSolution
from ..ocp.trajectory import Trajectory
from .transcribed import Transcribed

ACTIVE = 1e-6
"""A constraint nearer to its bound than this is active, relative to its size."""


@dataclass(frozen=True, kw_only=True)
class OptimalControl:
    """Solution of an optimal control or one-level estimation problem."""

    solution: NLPSolution
    trajectory: Trajectory
    converged: bool
    """Whether the first-order conditions hold, recomputed, relative to the size of the multipliers."""
    minimum: bool
    """Whether the Hessian of the Lagrangian is positive definite where active constraints leave freedom."""
    reason: str
    """One sentence: how it ended, and which constraint or variable is to blame if it failed."""


@dataclass(frozen=True, kw_only=True)
class Solve:
    """How to solve."""

    solver: Ipopt = Ipopt()
    tol: float = 1e-6
    """Tolerance of the certificate, relative to 1 + the largest multiplier."""

    def __call__(self, transcribed: Transcribed, start: Trajectory | np.ndarray, p: np.ndarray) -> OptimalControl:
        """Solve for (theta, p), shape (n_p,), from a trajectory or from unknowns of shape (n_w,)."""
        nlp = transcribed.nlp
        if p.shape != (nlp.p.numel(),):
            names = ", ".join(transcribed.problem.parameter_names) or "none"
            raise ProblemError(f"the parameters must be {nlp.p.numel()} numbers ({names}), got shape {p.shape}")
        bad = np.flatnonzero(~np.isfinite(p))
        if bad.size:
            raise ProblemError(f"{transcribed.problem.parameter_names[bad[0]]} is {p[bad[0]]}: give a finite number")
        w0 = transcribed.start(start) if isinstance(start, Trajectory) else start
        solution = self.solver.solve(nlp, w0, p)
        # A Lagrangian of large terms cannot vanish to an absolute tolerance.
        size = 1.0 + float(np.max(np.abs(np.concatenate([solution.lam_g, solution.lam_w])), initial=0.0))
        converged = solution.is_optimal(self.tol * size)
        reason = "solved" if converged else explain(transcribed, solution, p)
        return OptimalControl(
            solution=solution,
            trajectory=transcribed.trajectory(solution.w, p),
            converged=converged,
            minimum=converged and smallest_curvature(nlp, solution, p) > 0.0,
            reason=reason,
        )


def explain(transcribed: Transcribed, solution: NLPSolution, p: np.ndarray) -> str:
    """One sentence on why a solve for parameters p, shape (n_p,), failed, with names of constraints and variables."""
    nlp = transcribed.nlp
    g = np.asarray(ca.Function("g", [nlp.w, nlp.p], [nlp.g])(solution.w, p)).ravel()
    bad = np.flatnonzero(~np.isfinite(g))
    # An equation tells more than the objective, whose terms it spoils.
    if bad.size:
        return f"{transcribed.constraint_names[bad[0]]} evaluates to {g[bad[0]]}"
    return named(transcribed, blame(nlp, solution.w, p, solution.outcome))


def named(transcribed: Transcribed, sentence: str) -> str:
    """Put names for w[i], g[i] and p[i]."""
    names = {
        "w": transcribed.variable_names,
        "g": transcribed.constraint_names,
        "p": transcribed.problem.parameter_names,
    }

    def name(match: re.Match[str]) -> str:
        known = names[match[1]]
        return known[int(match[2])] if int(match[2]) < len(known) else match[0]

    return (
        re.sub(r"\b([wgp])\[(\d+)\]", name, sentence)
        .replace("constraint the ", "the ")
        .replace("constraint path constraint", "path constraint")
        .replace("constraint point constraint", "point constraint")
    )


def smallest_curvature(nlp: NLP, solution: NLPSolution, p: np.ndarray) -> float:
    """Smallest eigenvalue of the Hessian of the Lagrangian on the null space of the active constraints.

    Positive at a strict local minimum (second-order sufficiency; Nocedal and Wright 2006, Theorem 12.6); infinite where
    the active constraints leave no freedom. p has the shape (n_p,).
    """
    derivatives = nlp.derivatives or differentiate(nlp.w, nlp.p, nlp.f, nlp.g)
    upper = np.asarray(derivatives.hessian(solution.w, p, 1.0, solution.lam_g).full())
    hessian = upper + upper.T - np.diag(np.diag(upper))
    g, jacobian = (np.asarray(ca.DM(out).full()) for out in derivatives.jacobian(solution.w, p))
    rows = [
        jacobian[_active(g.ravel(), solution.lam_g, (nlp.lbg, nlp.ubg))],
        np.eye(solution.w.size)[_active(solution.w, solution.lam_w, (nlp.lbw, nlp.ubw))],
    ]
    active = np.vstack(rows)
    _, strengths, directions = np.linalg.svd(active, full_matrices=True)
    rank = int(np.sum(strengths > 1e-10 * strengths[0])) if strengths.size else 0
    free = directions[rank:]
    if not free.size:
        return float("inf")
    return float(np.linalg.eigvalsh(free @ hessian @ free.T)[0])


def _active(c: np.ndarray, lam: np.ndarray, bounds: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    slack = np.minimum(c - bounds[0], bounds[1] - c)
    # Interior points stop short of active bounds, where the multiplier is larger than the slack left.
    return (slack <= ACTIVE * (1.0 + np.abs(c))) | (np.abs(lam) > np.abs(slack))
