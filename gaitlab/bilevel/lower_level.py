"""Solutions of the lower level for given parameters, and how they move with them.

Near a solution its active set hardly changes, so a new p is answered by a few semismooth Newton steps on the KKT
conditions (primal-dual active set: Hintermüller, Ito, Kunisch, SIAM J. Optim. 13, 2003), started from a first-order
prediction; the interior-point method is called where they do not converge. At the solution the same linear system gives
the derivatives in p by the implicit function theorem (Fiacco 1976), with the inequalities that hold with equality
counted as equations.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.sparse import csr_matrix

from ..nlp.derivatives import NLPDerivatives, differentiate
from ..nlp.diagnosis import blame, invalid_function
from ..nlp.ipopt import Ipopt
from ..nlp.outcome import Outcome
from ..nlp.solution import KKTConditions, NLPSolution
from ..nlp.solver import Multipliers, NLPSolver, PreparedSolver
from .active_system import ActiveSystem, KKTPattern, LocalModel, PrimalDual
from .inverse_problem import InverseProblem
from .multiplier_estimate import estimate_multipliers

ACCEPT = 1e-6
"""A lower-level solution with larger KKT residuals, relative to 1 + |grad f|, is not used."""


CONFIRM = 1e-3
"""A start with KKT residuals below this, relative to the gradient, is taken for a solution and only polished."""


@dataclass(frozen=True, kw_only=True)
class LowerSettings:
    """How the lower level is solved."""

    solver: NLPSolver = Ipopt(tol=1e-9)
    newton_tol: float = 1e-10
    """KKT residual, relative to 1 + |grad f|, at which the Newton steps stop."""
    newton_iterations: int = 12


@dataclass(frozen=True, kw_only=True)
class Response:
    """Lower-level solution for one p, with the upper level's functions and their total derivatives."""

    p: np.ndarray
    """Parameters, shape (n_p,)."""
    solution: NLPSolution
    residual: np.ndarray
    """Residual of the upper level, shape (n_m,)."""
    upper: np.ndarray
    """Upper-level constraints, shape (n_u,)."""
    size: float
    """1 + |grad f| of the lower level, the scale of its residuals."""

    @property
    def solved(self) -> bool:
        """Whether the lower level's conditions hold."""
        return self.solution.residuals.max() < ACCEPT * self.size

    @property
    def objective(self) -> float:
        """Half the sum of squares of the residual."""
        return 0.5 * float(self.residual @ self.residual)


@dataclass(frozen=True, kw_only=True)
class Slopes:
    """Total derivatives in p."""

    w: np.ndarray
    """dw/dp, shape (n_w, n_p)."""
    lam_w: np.ndarray
    """dlam_w/dp, shape (n_w, n_p)."""
    lam_g: np.ndarray
    """dlam_g/dp, shape (n_g, n_p)."""
    residual: np.ndarray
    """dr/dp, shape (n_m, n_p)."""
    upper: np.ndarray
    """du/dp, shape (n_u, n_p)."""


class LowerLevel:
    """The lower level of one inverse problem, solved as often as needed."""

    def __init__(self, problem: InverseProblem, settings: LowerSettings | None = None) -> None:
        self.problem, self.settings = problem, settings or LowerSettings()
        nlp = problem.nlp
        self._solver: PreparedSolver = self.settings.solver.prepare(nlp)
        self._conditions = KKTConditions(nlp)
        self._derivatives: NLPDerivatives = nlp.derivatives or differentiate(nlp.w, nlp.p, nlp.f, nlp.g)
        sparsities = self._derivatives.hessian.sparsity_out(0), self._derivatives.jacobian.sparsity_out(1)
        self._pattern = KKTPattern(*sparsities)
        functions = [problem.residual, problem.upper]
        slopes = [ca.jacobian(part, of) for part in functions for of in (nlp.w, nlp.p)]
        self._upper_level = ca.Function("upper_level", [nlp.w, nlp.p], [ca.densify(part) for part in functions])
        self._upper_slopes = ca.Function("upper_slopes", [nlp.w, nlp.p], slopes)
        self.iterations = 0
        """Iterations of the lower level's solvers so far."""

    def start(self, w0: np.ndarray, p: np.ndarray) -> Response:
        """Solve from a start w0, shape (n_w,), for p, shape (n_p,); quickly where w0 is a solution already."""
        solution = self._confirmed(w0, p) or self._polished(self._counted(self._solver.solve(w0, p)), p)
        return self.response(solution, p)

    def _confirmed(self, w0: np.ndarray, p: np.ndarray) -> NLPSolution | None:
        """Newton steps from w0 with estimated multipliers; None where w0 is not almost a solution."""
        f, gradient = self._derivatives.gradient(w0, p)
        g, jacobian = self._derivatives.jacobian(w0, p)
        gradient, g = (np.asarray(part.full()).ravel() for part in (gradient, g))
        point = estimate_multipliers(self.problem.nlp, w0, gradient, g, csr_matrix(jacobian.sparse()))
        if point is None:
            return None
        size = 1.0 + float(np.max(np.abs(gradient), initial=0.0))
        if not self._conditions.residuals(point.w, point.lam_w, point.lam_g, p).max() <= CONFIRM * size:
            return None
        found = self._newton(point, p)
        return found if found is not None and abs(found.f - float(f)) <= CONFIRM * (1.0 + abs(float(f))) else None

    def respond(self, p: np.ndarray, near: Response, slopes: Slopes | None = None) -> Response:
        """Solve for p, shape (n_p,), from a solution nearby; `slopes` at that solution give a better start."""
        start = _predict(near, p - near.p, slopes)
        solution = self._newton(start, p)
        if solution is None:
            bounds, multipliers = self.problem.nlp.bounds, Multipliers(lam_w=start.lam_w, lam_g=start.lam_g)
            w = np.clip(start.w, bounds.lbw, bounds.ubw)
            solution = self._polished(self._counted(self._solver.solve(w, p, multipliers)), p)
        if not solution.is_optimal(ACCEPT * near.size):
            cold = self._polished(self._counted(self._solver.solve(near.solution.w, p)), p)
            solution = solution if cold.residuals.max() > solution.residuals.max() else cold
        return self.response(solution, p)

    def _polished(self, solution: NLPSolution, p: np.ndarray) -> NLPSolution:
        """Exact activity: interior-point methods end a little inside, or outside, of large bounds."""
        found = self._newton(_point(solution), p) if solution.outcome is Outcome.SOLVED else None
        if found is None or found.f > solution.f + 1e-3 * (1.0 + abs(solution.f)):
            return solution
        return found

    def slopes(self, response: Response) -> Slopes | None:
        """Derivatives at a solution; None where its KKT matrix is singular."""
        x, p = response.solution, response.p
        mixed, jac_p = (np.asarray(out.full()) for out in self._derivatives.mixed(x.w, p, 1.0, x.lam_g))
        found = self._system(_point(x), p).slopes(mixed, jac_p)
        if found is None:
            return None
        dw, dlam_w, dlam_g = found
        r_w, r_p, u_w, u_p = (csr_matrix(out.sparse()) for out in self._upper_slopes(x.w, p))
        return Slopes(
            w=dw,
            lam_w=dlam_w,
            lam_g=dlam_g,
            residual=r_w @ dw + r_p.toarray(),
            upper=u_w @ dw + u_p.toarray(),
        )

    def not_a_minimum(self, response: Response) -> str | None:
        """Second-order test: None at a minimum, else a sentence that names a variable without curvature."""
        variable = self._system(_point(response.solution), response.p).flat_variable()
        if variable is None:
            return None
        return f"the lower level is stationary but no strict minimum: its objective is not curved along w[{variable}]"

    def failure(self, response: Response) -> str:
        """One sentence: why the lower level is not solved for these parameters."""
        x, nlp = response.solution, self.problem.nlp
        values = ", ".join(
            f"{self.problem.parameter_name(int(i))} = {response.p[i]:.4g}" for i in self.problem.free_index
        )
        return f"lower level at {values}: {x.status}; {blame(nlp, x.w, response.p, x.outcome)}"

    def invalid(self, w: np.ndarray, p: np.ndarray) -> str | None:
        """Name what is not finite at w, shape (n_w,), and p, shape (n_p,); None where all is."""
        found = invalid_function(self.problem.nlp, w, p)
        if found is not None:
            return f"lower level: {found}"
        for name, part in zip(("residual", "upper-level constraint"), self._upper_level(w, p), strict=True):
            bad = np.flatnonzero(~np.isfinite(np.asarray(part).ravel()))
            if bad.size:
                return f"{name} {bad[0]} is not finite"
        return None

    def _counted(self, solution: NLPSolution) -> NLPSolution:
        self.iterations += solution.iterations
        return solution

    def response(self, solution: NLPSolution, p: np.ndarray) -> Response:
        """Evaluate the upper level at a solution found elsewhere, for p, shape (n_p,)."""
        residual, upper = (np.asarray(out).ravel() for out in self._upper_level(solution.w, p))
        gradient = np.asarray(self._derivatives.gradient(solution.w, p)[1].full())
        size = 1.0 + float(np.max(np.abs(gradient), initial=0.0))
        return Response(p=p, solution=solution, residual=residual, upper=upper, size=size)

    def _with_multipliers(self, w: np.ndarray, p: np.ndarray) -> PrimalDual:
        """Least-squares multipliers of the constraints that w, shape (n_w,), fulfils with equality."""
        nlp = self.problem.nlp
        gradient = np.asarray(self._derivatives.gradient(w, p)[1].full()).ravel()
        g, jacobian = self._derivatives.jacobian(w, p)
        g = np.asarray(g.full()).ravel()
        c, lower, upper = np.append(g, w), np.append(nlp.lbg, nlp.lbw), np.append(nlp.ubg, nlp.ubw)
        room = np.maximum(1e-6 * np.maximum(np.abs(c), 1.0), 1e-6)
        low, high = c - lower <= room, upper - c <= room
        active = np.flatnonzero(low | high)
        normals = np.vstack([np.asarray(jacobian.full()), np.eye(w.size)])[active]
        lam = np.zeros(c.size)
        finite = np.all(np.isfinite(normals)) and np.all(np.isfinite(gradient))
        if finite:
            lam[active] = np.linalg.lstsq(normals.T, -gradient, rcond=None)[0]
        one_sided = lower < upper
        lam = np.where(one_sided & low, np.minimum(lam, 0.0), np.where(one_sided & high, np.maximum(lam, 0.0), lam))
        return PrimalDual(w=w, lam_w=lam[g.size :], lam_g=lam[: g.size])

    def _newton(self, start: PrimalDual, p: np.ndarray) -> NLPSolution | None:
        """Semismooth Newton from a good start; None where it does not converge."""
        x, smallest = start, np.inf
        for iteration in range(self.settings.newton_iterations + 1):
            residuals = self._conditions.residuals(x.w, x.lam_w, x.lam_g, p)
            f, gradient = self._derivatives.gradient(x.w, p)
            gradient = np.asarray(gradient.full()).ravel()
            if residuals.max() <= self.settings.newton_tol * (1.0 + float(np.max(np.abs(gradient), initial=0.0))):
                status = "Newton steps on the active set converged"
                return NLPSolution(
                    w=x.w,
                    lam_w=x.lam_w,
                    lam_g=x.lam_g,
                    f=float(f),
                    residuals=residuals,
                    status=status,
                    iterations=iteration,
                )
            # What Newton's method does not improve soon is left to a globalised method.
            if not residuals.max() <= 1e3 * smallest:
                return None
            smallest = min(smallest, residuals.max())
            step = self._system(x, p, gradient).newton_point()
            if step is None:
                return None
            x = step
            self.iterations += 1
        return None

    def _system(self, x: PrimalDual, p: np.ndarray, gradient: np.ndarray | None = None) -> ActiveSystem:
        if gradient is None:
            gradient = np.asarray(self._derivatives.gradient(x.w, p)[1].full()).ravel()
        g, jacobian = self._derivatives.jacobian(x.w, p)
        model = LocalModel(
            gradient=gradient,
            g=np.asarray(g.full()).ravel(),
            jacobian=np.array(jacobian.nonzeros()),
            hessian=np.array(self._derivatives.hessian(x.w, p, 1.0, x.lam_g).nonzeros()),
        )
        return ActiveSystem(self.problem.nlp, self._pattern, x, model)


def _point(solution: NLPSolution) -> PrimalDual:
    return PrimalDual(w=solution.w, lam_w=solution.lam_w, lam_g=solution.lam_g)


def _predict(near: Response, step: np.ndarray, slopes: Slopes | None) -> PrimalDual:
    x = _point(near.solution)
    if slopes is None:
        return x
    return PrimalDual(w=x.w + slopes.w @ step, lam_w=x.lam_w + slopes.lam_w @ step, lam_g=x.lam_g + slopes.lam_g @ step)
