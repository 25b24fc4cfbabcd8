"""The frame of all treatments: pose subproblems, follow them, cross over to a certified point."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace

import casadi as ca
import numpy as np

from ...errors import ProblemError
from ..diagnosis import invalid_function
from ..ipopt import Ipopt
from ..mpcc import MPCC
from ..mpcc_solution import MPCCSolution
from ..outcome import Outcome
from ..problem import NLP
from ..solver import NLPSolver
from .crossover import Crossover, Tolerances
from .gauss_newton import gauss_newton_derivatives
from .method import NO_PARAMETERS, PathEnd, Schedule, follow
from .slack_form import SlackForm


@dataclass(frozen=True, kw_only=True)
class Subproblems:
    """A family of nonlinear programs with parameters (p, value) that approaches an MPCC."""

    nlp: NLP
    """Its variables begin with those of the MPCC."""
    start: ca.Function
    """(variables of the MPCC, p) -> variables of the subproblem, to start from."""
    remainder: ca.Function
    """Variables of the subproblem -> how far they are from the problem, a number >= 0."""


@dataclass(frozen=True, kw_only=True)
class Treatment(ABC):
    """Common settings."""

    solver: NLPSolver = field(default_factory=Ipopt)
    schedule: Schedule
    tol: float = 1e-7
    """The path ends when the remainder is smaller."""
    tolerances: Tolerances = field(default_factory=Tolerances)
    crossover: bool = True
    """Whether the end of the path is made exactly complementary."""

    @abstractmethod
    def pose(self, problem: MPCC) -> Subproblems:
        """Subproblems of a problem."""

    def prepare(self, problem: MPCC) -> "PreparedTreatment":
        """Bind to a problem."""
        return PreparedTreatment(self, problem)

    def solve(self, problem: MPCC, w0: np.ndarray, p: np.ndarray = NO_PARAMETERS) -> MPCCSolution:
        """Solve once, from w0, shape (n_w,), for parameters p, shape (n_p,)."""
        return self.prepare(problem).solve(w0, p)


class PreparedTreatment:
    """A treatment bound to one problem."""

    def __init__(self, settings: Treatment, problem: MPCC) -> None:
        self._settings, self._problem = settings, problem
        self._subproblems = settings.pose(problem)
        self._solver = settings.solver.prepare(self._subproblems.nlp)
        self._crossover = Crossover(problem, settings.solver, settings.tolerances)

    def solve(self, w0: np.ndarray, p: np.ndarray = NO_PARAMETERS) -> MPCCSolution:
        """Solve from w0, shape (n_w,), for parameters p, shape (n_p,).

        Raises:
            ProblemError: w0 or p has a wrong shape or an entry that is not finite.
        """
        problem, sub = self._problem, self._subproblems
        problem.check_start(w0)
        if p.shape != (problem.p.numel(),):
            raise ProblemError(f"p must have shape ({problem.p.numel()},), got {p.shape}")
        start = np.asarray(sub.start(np.clip(w0, problem.lbw, problem.ubw), p)).ravel()
        invalid = invalid_function(sub.nlp, start, np.append(p, self._settings.schedule.first))
        if invalid is not None:
            end = PathEnd(w=start, outcome=Outcome.INVALID_NUMBER, status=invalid, iterations=0)
            return self._crossover.certify(w0, p, end, 0)
        end = follow(self._solver, self._settings.schedule, start, p, self._is_done)
        w = end.w[: problem.w.numel()]
        # What crashed or hung on the way would do so again.
        if not self._settings.crossover or end.outcome in (Outcome.CRASHED, Outcome.TIME_LIMIT):
            return self._crossover.certify(w, p, end, end.iterations)
        return self._crossover.finish(end, w, p)

    def _is_done(self, w: np.ndarray) -> bool:
        return float(self._subproblems.remainder(w)) <= self._settings.tol


def with_products(form: SlackForm, objective: ca.SX, products: ca.SX, p: ca.SX) -> Subproblems:
    """Subproblems with an objective and rows products <= 0, in the variables of a slack form.

    The remainder is the complementarity of the pairs.
    """
    m = form.problem
    n, n_w = products.numel(), form.problem.w.numel()
    nlp = NLP(
        w=m.w,
        p=p,
        f=objective,
        g=ca.vertcat(m.g, products),
        lbw=m.lbw,
        ubw=m.ubw,
        lbg=np.concatenate([m.lbg, np.full(n, -np.inf)]),
        ubg=np.concatenate([m.ubg, np.zeros(n)]),
    )
    if m.residual is not None:
        nlp = replace(nlp, derivatives=gauss_newton_derivatives(nlp, m.residual, objective - m.f))
    n_original = n_w - form.n_slacks
    remainder = ca.norm_inf(ca.fmin(m.G, m.H)) if m.n_pairs else ca.SX(0)
    return Subproblems(
        nlp=nlp,
        start=ca.Function("start", [m.w[:n_original], m.p], [form.start]),
        remainder=ca.Function("remainder", [m.w], [remainder]),
    )
