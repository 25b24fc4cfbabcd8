r"""Indirect all-at-once approach: the lower level replaced by Pontryagin's maximum principle (Hatz 2014, ch. 6).

For one stage with a scalar bounded control, Mayer and Lagrange criteria and boundary conditions, the Hamiltonian

.. math:: H(x, \lambda, u) = \lambda^T f(x, u; p) - \sum_i \theta_i \ell_i(x, u; p)

is maximised by the optimal control, and the adjoint variables obey d lambda / dt = -dH/dx with transversality
conditions where states or the duration are free (6.2), (6.26). H must be quadratic in u. Given the sequence of arcs on
which the control is at a bound or inside, this is a multi-point boundary value problem with free switching times: a
`MultiStageProblem` without controls. Without that sequence the maximising control is one expression with kinks (6.17),
which needs fine grids but lets measurements lie at fixed fractions of the whole motion: with free parameters it is the
estimation problem (6.31).

Readings: (6.31) prints the friction term of the second adjoint equation with the sign opposite to (6.14), which is the
derivative of the Hamiltonian; Setting 1 of Table 6.2 prints adjoints for theta = (1, 1), not (1/2, 1/2).
"""

from dataclasses import dataclass
from enum import StrEnum

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..nlp.solution import NLPSolution
from ..ocp.constraint import Bounds, Constraint, Point, PointConstraint
from ..ocp.cost import lagrange_terms, mayer_terms
from ..ocp.problem import MultiStageProblem
from ..ocp.stage import Stage
from ..ocp.trajectory import StageTrajectory, Trajectory
from ..ocp.transition import continuous
from ..transcription.transcribed import Transcribed


class Arc(StrEnum):
    """Where the control is."""

    UPPER = "at its upper bound"
    INSIDE = "inside its bounds"
    LOWER = "at its lower bound"
    ANY = "wherever the Hamiltonian is largest"


@dataclass(frozen=True, kw_only=True, eq=False)
class Hamiltonian:
    """Expressions of the maximum principle in (x, lam, u; theta, p)."""

    stage: Stage
    theta: ca.SX
    """Weights, symbols of shape (n_theta, 1)."""
    p: ca.SX
    """Parameters, symbols of shape (n_p, 1)."""
    lam: ca.SX
    """Adjoint variables, symbols of shape (n_x, 1)."""
    value: ca.SX
    """H, scalar."""
    terminal: ca.SX
    """Weighted Mayer terms, scalar, of (x, q)."""

    @property
    def adjoint_rate(self) -> ca.SX:
        """-dH/dx, shape (n_x, 1)."""
        return -ca.gradient(self.value, self.stage.x)

    @property
    def inside_control(self) -> ca.SX:
        """Stationary control of the quadratic H."""
        u = self.stage.u
        slope = ca.gradient(self.value, u)
        return ca.substitute(-slope / ca.gradient(slope, u), u, 0)

    def control(self, arc: Arc) -> ca.SX:
        """Control on an arc."""
        bounds = self.stage.control_bounds
        lower, upper = float(bounds.lower[0]), float(bounds.upper[0])
        if arc is Arc.ANY:
            return self._maximiser(lower, upper)
        return self.inside_control if arc is Arc.INSIDE else ca.SX(upper if arc is Arc.UPPER else lower)

    def _maximiser(self, lower: float, upper: float) -> ca.SX:
        u = self.stage.u
        gain = ca.substitute(self.value, u, upper) - ca.substitute(self.value, u, lower)
        corner = ca.if_else(gain > 0, upper, lower)
        curvature = ca.jacobian(ca.gradient(self.value, u), u)
        return ca.if_else(curvature < 0, ca.fmin(ca.fmax(self.inside_control, lower), upper), corner)


def hamiltonian(problem: MultiStageProblem) -> Hamiltonian:
    """Form the Hamiltonian of a problem.

    Raises:
        ProblemError: The problem is not of the kind treated here.
    """
    _require_kind(problem)
    stage = problem.stages[0]
    theta, lam = ca.SX.sym("theta", len(problem.criteria)), ca.SX.sym("lam", stage.n_x)
    value = ca.dot(lam, stage.ode) - ca.dot(theta, lagrange_terms(stage, problem.criteria))
    curvature = ca.jacobian(ca.gradient(value, stage.u), stage.u)
    if ca.depends_on(curvature, stage.u):
        raise ProblemError(f"the Hamiltonian of stage '{stage.name}' must be quadratic in {stage.u}")
    terminal = ca.dot(theta, mayer_terms(stage, problem.criteria))
    return Hamiltonian(stage=stage, theta=theta, p=problem.p, lam=lam, value=value, terminal=terminal)


def _require_kind(problem: MultiStageProblem) -> None:
    stage, complaint = problem.stages[0], ""
    bounds = stage.control_bounds
    if len(problem.stages) > 1 or problem.points or stage.path.lower.size or stage.x_bounds is not None:
        complaint = "one stage with control bounds and boundary conditions only"
    elif stage.n_u != 1 or not (np.isfinite(bounds.lower) & np.isfinite(bounds.upper)).all():
        complaint = "one control, bounded on both sides"
    elif problem.q.numel() != 1 or not ca.is_equal(ca.SX(stage.duration), problem.q):
        complaint = "the duration as its only control value"
    elif ca.depends_on(ca.vertcat(stage.ode, *stage.lagrange.values()), ca.vertcat(stage.t, problem.q)):
        complaint = "equations that do not depend on time"
    if complaint:
        raise ProblemError(f"the indirect approach needs {complaint}")


def boundary_value_problem(problem: MultiStageProblem, arcs: tuple[Arc, ...] = (Arc.ANY,)) -> MultiStageProblem:
    """Conditions of the maximum principle for a sequence of arcs; its parameters are (theta, p).

    States are (x, lam), control values are the durations of the arcs.

    Raises:
        ProblemError: The problem is not of the kind treated here, or there are no arcs.
    """
    if not arcs:
        raise ProblemError("the indirect approach needs at least one arc")
    principle = hamiltonian(problem)
    stage, y = principle.stage, ca.vertcat(principle.stage.x, principle.lam)
    durations = ca.vertcat(*[ca.SX.sym(f"duration of arc {i}") for i in range(len(arcs))])
    stages = tuple(
        _arc_stage(principle, f"arc {i}: {arc}", principle.control(arc), durations[i]) for i, arc in enumerate(arcs)
    )
    n = len(arcs)
    free = Bounds(lower=np.full(n, 1e-6), upper=np.full(n, float(problem.control_value_bounds.upper[0])))
    result = MultiStageProblem(
        stages=stages,
        transitions=tuple(continuous(y) for _ in range(n - 1)),
        q=durations,
        q_bounds=free,
        p=ca.vertcat(principle.theta, principle.p),
    )
    values = {"start": stage.start, "end": stage.end}
    ends = {"start": result.point(0.0), "end": result.point(1.0, stage=n - 1)}
    rules = [_boundary(principle, name, values[name], ends[name]) for name in values]
    rules += _switches(principle, result, arcs)
    rules.append(_free_duration(principle, problem.q, ends["end"], arcs[-1]))
    return result.with_points(*rules)


def _arc_stage(principle: Hamiltonian, name: str, control: ca.SX, duration: ca.SX) -> Stage:
    stage = principle.stage
    rates = ca.vertcat(stage.ode, principle.adjoint_rate)
    return Stage(
        name=name,
        x=ca.vertcat(stage.x, principle.lam),
        ode=ca.substitute(rates, stage.u, control),
        duration=duration,
    )


def _at(principle: Hamiltonian, expression: ca.SX, point: Point) -> ca.SX:
    return ca.substitute(expression, ca.vertcat(principle.stage.x, principle.lam), point.x)


def _equation(name: str, point: Point, expression: ca.SX) -> PointConstraint:
    zeros = np.zeros(expression.numel())
    return PointConstraint(
        points=(point,), constraint=Constraint(name=name, expression=expression, lower=zeros, upper=zeros)
    )


def _boundary(principle: Hamiltonian, name: str, bounds: Bounds | None, point: Point) -> PointConstraint:
    """Fixed states, and transversality where they are free: lam = -d phi / dx at the end, 0 at the start (6.26)."""
    x, lam = principle.stage.x, principle.lam
    known = bounds or Bounds.none(x.numel())
    if np.any(known.finite & ~known.fixed):
        raise ProblemError(f"the {name} of stage '{principle.stage.name}' must be fixed or free in every state")
    slope = ca.gradient(principle.terminal, x) if name == "end" else ca.SX.zeros(x.numel())
    rows = [x[i] - known.lower[i] if known.fixed[i] else lam[i] + slope[i] for i in range(x.numel())]
    return _equation(f"transversality at the {name}", point, _at(principle, ca.vertcat(*rows), point))


def _switches(principle: Hamiltonian, result: MultiStageProblem, arcs: tuple[Arc, ...]) -> list[PointConstraint]:
    """Continuity of the control: the stationary control meets the bound; between bounds H does not depend on u."""
    rules = list[PointConstraint]()
    for i, (before, after) in enumerate(zip(arcs, arcs[1:], strict=False)):
        point = result.point(1.0, stage=i)
        gap = principle.control(before) - principle.control(after)
        if Arc.INSIDE not in (before, after):
            u = principle.stage.u
            ends = [ca.substitute(principle.value, u, principle.control(arc)) for arc in (before, after)]
            gap = ends[0] - ends[1]
        rules.append(_equation(f"switch {i}", point, _at(principle, gap, point)))
    return rules


def _free_duration(principle: Hamiltonian, duration: ca.SX, point: Point, arc: Arc) -> PointConstraint:
    """H = d phi / dT at the end (6.26c)."""
    gap = ca.substitute(principle.value, principle.stage.u, principle.control(arc))
    gap -= ca.gradient(principle.terminal, duration)
    return _equation("free duration", point, _at(principle, gap, point))


def start_from(
    transcribed: Transcribed, solution: NLPSolution, p: np.ndarray, arcs: tuple[Arc, ...] = (Arc.ANY,)
) -> Trajectory:
    """Start of the boundary value problem from a direct solution by multiple shooting for (theta, p), shape (n_p,).

    The multiplier of the defect before a node is minus the adjoint there; the arcs share the time as the control does.
    """
    stage = transcribed.trajectory(solution.w, p).stages[0]
    n, n_x = len(stage.fraction) - 1, stage.x.shape[1]
    adjoint = -solution.lam_g[: n * n_x].reshape(n, n_x)
    adjoint = np.vstack([2 * adjoint[0] - adjoint[1], adjoint])
    y = StageTrajectory(
        fraction=stage.fraction, duration=stage.duration, x=np.hstack([stage.x, adjoint]), u=np.zeros((n + 1, 0))
    )
    joints = np.concatenate([[0.0], _switching_times(transcribed, stage, arcs), [1.0]])
    stages, samples = list[StageTrajectory](), np.linspace(0.0, 1.0, 21)
    for left, right in zip(joints, joints[1:], strict=False):
        x = y.state_at(left + samples * (right - left))
        stages.append(
            StageTrajectory(fraction=samples, duration=(right - left) * y.duration, x=x, u=np.zeros((samples.size, 0)))
        )
    return Trajectory(stages=tuple(stages), q=np.diff(joints) * stage.duration)


def arcs_of(transcribed: Transcribed, trajectory: Trajectory) -> tuple[Arc, ...]:
    """Sequence of arcs of a direct solution with piecewise constant controls."""
    kinds = _kinds(transcribed, trajectory.stages[0])
    return tuple(kind for i, kind in enumerate(kinds) if i == 0 or kind is not kinds[i - 1])


def _kinds(transcribed: Transcribed, stage: StageTrajectory) -> list[Arc]:
    bounds = transcribed.problem.stages[0].control_bounds
    lower, upper = float(bounds.lower[0]), float(bounds.upper[0])
    near = 1e-4 * (upper - lower)
    return [Arc.UPPER if u > upper - near else Arc.LOWER if u < lower + near else Arc.INSIDE for u in stage.u[:-1, 0]]


def _switching_times(transcribed: Transcribed, stage: StageTrajectory, arcs: tuple[Arc, ...]) -> np.ndarray:
    kinds = _kinds(transcribed, stage)
    changes = [i for i in range(1, len(kinds)) if kinds[i] is not kinds[i - 1]]
    if len(changes) == len(arcs) - 1:
        return stage.fraction[changes]
    return np.linspace(0.0, 1.0, len(arcs) + 1)[1:-1]
