"""Filter SQP (Fletcher and Leyffer 2002) as implemented in Uno, through CasADi, in a process of its own.

Uno is native code that may crash or loop. The parent sends the problem once and then one message a solve; a child
that dies or takes too long is a result with a reason, and the next solve starts a new child.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from .child_process import ChildFailure, ChildProcess
from .outcome import Outcome
from .problem import NLP, Bounds
from .solution import KKTConditions, NLPSolution
from .solver import Multipliers
from .uno_call import UnoAnswer, UnoCall, UnoOptions, UnoProblem, UnoRequest, no_answer

CHILD = "gaitlab.nlp.uno_child"

OUTCOMES = {
    "Converged with feasible KKT point": Outcome.SOLVED,
    "Converged with feasible FJ point": Outcome.SOLVED,
    "Converged with infeasible stationary point": Outcome.INFEASIBLE,
    "Terminated with infeasible small step": Outcome.INFEASIBLE,
    "Terminated with feasible small step": Outcome.STALLED,
    "Terminated with unbounded problem": Outcome.UNBOUNDED,
}
CODES = {"SOLVER_RET_LIMITED": Outcome.ITERATION_LIMIT, "SOLVER_RET_NAN": Outcome.INVALID_NUMBER}


@dataclass(frozen=True, kw_only=True)
class Uno:
    """Trust-region filter SQP with exact Hessians and an active-set QP solver."""

    preset: str = "filtersqp"
    tol: float = 1e-8
    """Tolerance on stationarity, feasibility and complementarity."""
    max_iter: int = 500
    seconds: float = 60.0
    """Wall time of one solve [s]."""
    memory: int = 8_000_000_000
    """Address space of the child [bytes]."""
    isolated: bool = True
    """Whether Uno runs in a child. Without, its crash is the caller's crash and `seconds` is left to the caller."""

    def solve(self, nlp: NLP, w0: np.ndarray, p: np.ndarray) -> NLPSolution:
        """Solve `nlp` for the parameters p, shape (n_p,), starting from w0, shape (n_w,)."""
        with self.prepare(nlp) as prepared:
            return prepared.solve(w0, p)

    def prepare(self, nlp: NLP) -> "PreparedUno":
        """Bind to `nlp`; the child starts with the first solve and ends with the object."""
        return PreparedUno(self, nlp)

    def casadi_options(self) -> UnoOptions:
        """Options of CasADi's interface."""
        uno: dict[str, str | float | int] = {
            "preset": self.preset,
            "logger": "SILENT",
            "primal_tolerance": self.tol,
            "dual_tolerance": self.tol,
            "max_iterations": self.max_iter,
        }
        return {"uno": uno, "print_time": False, "error_on_fail": False, "show_eval_warnings": False}


class PreparedUno:
    """Uno bound to one problem, alive as long as its child."""

    def __init__(self, settings: Uno, nlp: NLP) -> None:
        self._settings, self._nlp = settings, nlp
        self._conditions = KKTConditions(nlp)
        functions = ca.Function("nlp", [nlp.w, nlp.p], [nlp.f, nlp.g])
        problem = UnoProblem(functions=functions.serialize(), options=settings.casadi_options())
        self._child = ChildProcess(CHILD, problem, memory=settings.memory)
        self._call = None if settings.isolated else UnoCall(problem)

    def __enter__(self) -> "PreparedUno":
        return self

    def __exit__(self, *_: object) -> None:
        self._child.close()

    def solve(
        self, w0: np.ndarray, p: np.ndarray, multipliers: Multipliers | None = None, bounds: Bounds | None = None
    ) -> NLPSolution:
        """Solve for the parameters p, shape (n_p,), from w0, shape (n_w,)."""
        limits = bounds or self._nlp.bounds
        n_g = self._nlp.g.numel()
        duals = multipliers or Multipliers(lam_w=np.zeros(w0.size), lam_g=np.zeros(n_g))
        start = np.clip(w0, limits.lbw, limits.ubw)
        request = UnoRequest(w0=start, p=p, lam_w0=duals.lam_w, lam_g0=duals.lam_g, bounds=limits)
        answer: UnoAnswer | ChildFailure = (
            self._call(request) if self._call is not None else self._child.ask(request, self._settings.seconds)
        )
        if isinstance(answer, ChildFailure):
            code = Outcome.TIME_LIMIT if answer.timed_out else Outcome.CRASHED
            answer = no_answer(request, answer.reason, code)
        return NLPSolution(
            w=answer.w,
            lam_w=answer.lam_w,
            lam_g=answer.lam_g,
            f=answer.f,
            residuals=self._conditions.residuals(answer.w, answer.lam_w, answer.lam_g, p, limits),
            status=answer.status,
            outcome=_outcome(answer),
            iterations=answer.iterations,
        )


def _outcome(answer: UnoAnswer) -> Outcome:
    if answer.code in (Outcome.TIME_LIMIT, Outcome.CRASHED):
        return Outcome(answer.code)
    # The code is the more telling of the two where Uno did not end by itself.
    return CODES.get(answer.code) or OUTCOMES.get(answer.status, Outcome.STALLED)
