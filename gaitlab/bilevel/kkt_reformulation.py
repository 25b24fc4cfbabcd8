r"""All-at-once: the lower level's KKT conditions as constraints of one program with complementarity (Hatz 2014, ch. 5).

.. math::

    \underset{w, p, \lambda, z}{\text{minimize}} \; \tfrac{1}{2} |r(w, p)|^2 \quad \text{subject to} \quad
    \nabla_w f + \nabla_w g^T (\lambda + z^u - z^l) + z^u_w - z^l_w = 0, \;
    0 \le c - \underline{c} \perp z^l \ge 0, \; 0 \le \overline{c} - c \perp z^u \ge 0

with lambda the multipliers of equations and c the inequalities and bounds. The start solves the lower level once.
"""

import time
from dataclasses import dataclass, field, replace

import casadi as ca
import numpy as np

from ..nlp.complementarity.method import MPCCMethod
from ..nlp.complementarity.relaxation import Relaxation
from ..nlp.mpcc import MPCC
from ..nlp.mpcc_solution import MPCCSolution
from ..nlp.outcome import Outcome
from ..nlp.solution import KKTConditions, NLPSolution
from .inverse_finish import Stop, finish, first_response, largest_upper_violation
from .inverse_problem import InverseProblem
from .inverse_result import InverseResult, InverseStatus
from .lower_level import LowerLevel, LowerSettings, Response

STATUS = {
    Outcome.SOLVED: InverseStatus.CONVERGED,
    Outcome.INFEASIBLE: InverseStatus.INFEASIBLE,
    Outcome.UNBOUNDED: InverseStatus.UNBOUNDED,
    Outcome.STALLED: InverseStatus.STALLED,
    Outcome.ITERATION_LIMIT: InverseStatus.ITERATION_LIMIT,
    Outcome.TIME_LIMIT: InverseStatus.TIME_LIMIT,
    Outcome.INVALID_NUMBER: InverseStatus.INVALID_NUMBER,
    Outcome.CRASHED: InverseStatus.CRASHED,
}


@dataclass(frozen=True, kw_only=True)
class KKTReformulation:
    """Settings: which treatment of complementarity, with which solver."""

    method: MPCCMethod = field(default_factory=Relaxation)
    lower: LowerSettings = field(default_factory=LowerSettings)
    """Solves the lower level for the start, and certifies the end."""
    gauss_newton: bool = False
    """Whether IPOPT gets the Gauss-Newton Hessian instead of the exact one; Uno differentiates by itself."""

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from w0, shape (n_w,), and p0, shape (n_p,).

        Raises:
            ProblemError: p0 has a wrong shape or is not finite.
        """
        return self.prepare(problem).solve(w0, p0)

    def prepare(self, problem: InverseProblem) -> "PreparedReformulation":
        """Form the program and its derivatives once for many starts."""
        return PreparedReformulation(self, problem)


class PreparedReformulation:
    """The method bound to one problem."""

    def __init__(self, settings: KKTReformulation, problem: InverseProblem) -> None:
        self._problem = problem
        self._one_level = OneLevel(problem)
        mpcc = self._one_level.mpcc
        self._method = settings.method.prepare(mpcc if settings.gauss_newton else replace(mpcc, residual=None))
        self._lower = LowerLevel(problem, settings.lower)
        self._conditions = KKTConditions(problem.nlp)

    def solve(self, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from w0, shape (n_w,), and p0, shape (n_p,)."""
        began = time.perf_counter()
        self._lower.iterations = 0
        response = first_response(self._lower, w0, p0, began)
        if isinstance(response, InverseResult):
            return response
        found = self._method.solve(self._one_level.pack(response))
        end = self._response(found)
        status, reason = self._judge(found, end)
        return finish(self._lower, end, Stop(status=status, reason=reason, iterations=found.iterations), began)

    def _judge(self, found: MPCCSolution, end: Response) -> tuple[InverseStatus, str]:
        violation, sentence = largest_upper_violation(self._problem, end.upper)
        if violation > 1e-5:
            return InverseStatus.INFEASIBLE, f"{sentence}; {found.reason}"
        if not end.solved:
            solved = found.outcome is Outcome.SOLVED
            return (InverseStatus.LOWER_LEVEL_FAILED, self._lower.failure(end)) if solved else _said(found)
        flat = self._lower.not_a_minimum(end)
        if flat is not None:
            return InverseStatus.LOWER_LEVEL_FAILED, f"{flat}; {found.reason}"
        return _said(found)

    def _response(self, found: MPCCSolution) -> Response:
        w, p, lam_w, lam_g = self._one_level.unpack(found.w)
        solution = NLPSolution(
            w=w,
            lam_w=lam_w,
            lam_g=lam_g,
            f=found.f,
            residuals=self._conditions.residuals(w, lam_w, lam_g, p),
            status=found.reason,
            outcome=found.outcome,
        )
        return self._lower.response(solution, p)


def _said(found: MPCCSolution) -> tuple[InverseStatus, str]:
    return STATUS[found.outcome], found.reason


class OneLevel:
    """The program with complementarity that replaces a bilevel problem, and the way there and back."""

    def __init__(self, problem: InverseProblem) -> None:
        self._problem, nlp = problem, problem.nlp
        self._free = problem.free_index
        n_w, n_g = nlp.w.numel(), nlp.g.numel()
        lower, upper = np.concatenate([nlp.lbg, nlp.lbw]), np.concatenate([nlp.ubg, nlp.ubw])
        self._equal = np.flatnonzero(lower == upper)
        self._low = np.flatnonzero((lower < upper) & np.isfinite(lower))
        self._high = np.flatnonzero((lower < upper) & np.isfinite(upper))
        self._n_w, self._n_g = n_w, n_g
        self.mpcc = self._program(lower, upper)

    def _program(self, lower: np.ndarray, upper: np.ndarray) -> MPCC:
        problem, nlp = self._problem, self._problem.nlp
        lam = ca.SX.sym("lam", self._equal.size)
        z_low, z_high = ca.SX.sym("z_low", self._low.size), ca.SX.sym("z_high", self._high.size)
        p = self._parameters()
        multipliers = ca.SX.zeros(lower.size, 1)
        for places, part, sign in [(self._equal, lam, 1.0), (self._low, z_low, -1.0), (self._high, z_high, 1.0)]:
            for k, i in enumerate(places):
                multipliers[int(i)] += sign * part[k]
        every = np.arange(lower.size)
        lam_g, lam_w = _pick(multipliers, every[: self._n_g]), _pick(multipliers, every[self._n_g :])
        stationarity = ca.gradient(nlp.f, nlp.w) + ca.jtimes(nlp.g, nlp.w, lam_g, True) + lam_w
        c = ca.vertcat(nlp.g, nlp.w)
        low, high, equal = (
            ca.vertcat(*(c[int(i)] for i in at), ca.SX(0, 1)) for at in (self._low, self._high, self._equal)
        )
        total = ca.vertcat(
            *[sum((nlp.p[i] for i in problem.simplex), ca.SX(0))][: int(bool(problem.simplex))], ca.SX(0, 1)
        )
        g = ca.vertcat(stationarity, equal, total, problem.upper)
        fixed = np.concatenate([np.zeros(self._n_w), lower[self._equal], np.ones(total.numel())])
        parts = [problem.residual, g, low - lower[self._low], upper[self._high] - high]
        residual, g, first_low, first_high = ca.substitute(parts, [nlp.p], [p])
        n_free, n_z = lam.numel(), z_low.numel() + z_high.numel()
        endless = np.full(self._n_w + n_free, np.inf)
        parameters = problem.lbp[self._free], problem.ubp[self._free]
        return MPCC(
            w=ca.vertcat(nlp.w, _pick(nlp.p, self._free), lam, z_low, z_high),
            f=0.5 * ca.sumsqr(residual),
            residual=residual,
            g=g,
            lbg=np.concatenate([fixed, problem.lbu]),
            ubg=np.concatenate([fixed, problem.ubu]),
            G=ca.vertcat(first_low, first_high),
            H=ca.vertcat(z_low, z_high),
            lbw=np.concatenate([-endless[: self._n_w], parameters[0], -endless[self._n_w :], np.zeros(n_z)]),
            ubw=np.concatenate([endless[: self._n_w], parameters[1], endless[self._n_w :], np.full(n_z, np.inf)]),
        )

    def _parameters(self) -> ca.SX:
        """The vector p with numbers in the places of fixed entries, shape (n_p, 1)."""
        p, nominal = self._problem.nlp.p, self._problem.p_nominal
        return ca.vertcat(*(p[i] if self._problem.free[i] else ca.SX(nominal[i]) for i in range(p.numel())))

    def pack(self, response: Response) -> np.ndarray:
        """Variables of the program, shape (n,), at a solution of the lower level."""
        x = response.solution
        lam = np.concatenate([x.lam_g, x.lam_w])
        z_low, z_high = np.maximum(-lam[self._low], 0.0), np.maximum(lam[self._high], 0.0)
        return np.concatenate([x.w, response.p[self._free], lam[self._equal], z_low, z_high])

    def unpack(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """W (n_w,), p (n_p,), lam_w (n_w,), lam_g (n_g,) of variables of shape (n,)."""
        sizes = [self._n_w, self._free.size, self._equal.size, self._low.size]
        w, y, lam, z_low, z_high = np.split(v, np.cumsum(sizes))
        p = self._problem.p_nominal.copy()
        p[self._free] = y
        multipliers = np.zeros(self._n_g + self._n_w)
        multipliers[self._equal] = lam
        multipliers[self._low] -= z_low
        multipliers[self._high] += z_high
        return w, p, multipliers[self._n_g :], multipliers[: self._n_g]


def _pick(vector: ca.SX, places: np.ndarray) -> ca.SX:
    return ca.vertcat(*(vector[int(i)] for i in places), ca.SX(0, 1))
