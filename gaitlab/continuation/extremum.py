"""Extrema of a monitor over a solution manifold by successive continuation.

From any solution: follow the trivial branch (all multipliers zero) to a fold of the objective mu_1, switch there to
the branch of nontrivial multipliers, follow it to d mu_1 = 1, then release one parameter after the other, each until
its d mu = 0 (Kernevez, Doedel 1987; Li, Anderson, Dankowicz). Relaxed complementarity, if there is any, is tightened
last. No start near the extremum is needed, and every stage ends at a partial extremum with its own certificate.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from ..errors import ProblemError
from .adjoints import estimated_multipliers, held_monitors, reduced_curvature
from .extended_system import ADJOINT, RELAXATION, ExtendedSystem
from .feasible_start import feasible_start
from .path_events import BranchPoint, Crossing, Event
from .path_following import NO_SIGN, LocatedPoint, Path, PathFollowing, branch_direction, switched, tangent_at
from .staged_function import Role
from .zero_problem import ZeroProblem

NORMAL = 1e-6
"""Share of the objective's multiplier in the direction of the new branch below which it cannot reach one."""


class Kind(StrEnum):
    """Second-order test of an extremum."""

    MINIMUM = "minimum"
    MAXIMUM = "maximum"
    SADDLE = "saddle"
    UNKNOWN = "not decided: a direction without curvature"


@dataclass(frozen=True, kw_only=True, eq=False)
class ExtremumProblem:
    """Make a monitor extremal over the solutions of a problem."""

    problem: ZeroProblem
    objective: str
    """Name of the monitor mu_1."""
    parameters: tuple[str, ...]
    """Monitors mu_2 in the order in which they are released; all other monitors keep their values."""
    maximise: bool = False
    """Which way to go first, and the sign of the multipliers of inequalities."""
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=lambda: {})
    """Where a path ends without success."""
    relaxation: float = 1e-2
    """Relaxation of complementarity on the way."""
    remesh: Callable[[ZeroProblem, np.ndarray], ZeroProblem] | None = None
    """The same problem on a better mesh, starting at the unknowns u, shape (n_u,), of the old one."""

    def __post_init__(self) -> None:
        monitors = self.problem.names_of(Role.MONITOR)
        for name in (self.objective, *self.parameters):
            if name not in monitors:
                raise ProblemError(f"'{name}' is no monitor of the problem; there are {monitors}")
        if self.objective in self.parameters or len(set(self.parameters)) != len(self.parameters):
            raise ProblemError(f"each parameter once, and not the objective: {self.parameters}")
        if not 0 <= self.n_first <= len(self.parameters):
            dof = self.problem.n_u - self.problem.n_zero
            raise ProblemError(
                f"{self.problem.n_u} unknowns and {self.problem.n_zero} equations leave {dof} directions, which "
                f"{len(monitors)} monitors cannot make a path of: there must be {dof} or {dof + 1}"
            )

    @property
    def n_first(self) -> int:
        """How many parameters are free from the start, so that the solutions form a path."""
        return len(self.problem.names_of(Role.MONITOR)) - (self.problem.n_u - self.problem.n_zero)

    @property
    def target(self) -> float:
        """Value of d mu_1: for both signs multipliers of inequalities are not negative."""
        return -1.0 if self.maximise else 1.0


@dataclass(frozen=True, kw_only=True)
class ExtremumStage:
    """One path of the sequence and the point it led to."""

    name: str
    objective: float
    """Value of the objective at that point."""
    point: LocatedPoint
    path: Path = field(repr=False)


@dataclass(frozen=True, kw_only=True)
class Extremum:
    """Where the sequence ended."""

    stages: tuple[ExtremumStage, ...]
    system: ExtendedSystem | None = field(repr=False)
    """The last system; None where the first stage failed."""
    x: np.ndarray = field(repr=False)
    """Unknowns of the last stage, shape (n_x,)."""
    objective: float
    parameters: Mapping[str, float]
    """Values of all monitors."""
    multipliers: Mapping[str, float]
    """Derivative of the extremal objective with respect to each monitor that was held, zero for those released."""
    curvature: np.ndarray = field(repr=False)
    """Eigenvalues of the second derivative along the solutions, shape (n_free,); empty where they are not known."""
    residual: float
    """Largest equation of the whole optimality system, evaluated anew."""
    converged: bool
    reason: str

    @property
    def kind(self) -> Kind:
        """What the second-order test says."""
        if not len(self.curvature) or np.min(np.abs(self.curvature)) <= 1e-9 * np.max(np.abs(self.curvature)):
            return Kind.UNKNOWN
        if np.all(self.curvature > 0.0):
            return Kind.MINIMUM
        return Kind.MAXIMUM if np.all(self.curvature < 0.0) else Kind.SADDLE


@dataclass(frozen=True, kw_only=True)
class SuccessiveContinuation:
    """Settings of the method."""

    path: PathFollowing = field(default_factory=PathFollowing)
    certificate: float = 1e-8
    """Largest residual of an accepted extremum."""

    def solve(self, wanted: ExtremumProblem) -> Extremum:
        """Run all stages. A stage that does not reach its event ends the run with the reason in the result."""
        return _Sequence(self, wanted).run()


class _Stuck(Exception):
    """A stage did not reach its event; the text says why."""


class _Sequence:
    """One run: the settings, the problem, and the stages so far."""

    def __init__(self, method: SuccessiveContinuation, wanted: ExtremumProblem) -> None:
        self.method, self.wanted, self.problem = method, wanted, wanted.problem
        self.stages: list[ExtremumStage] = []
        self.free = wanted.parameters[: wanted.n_first]
        self.d_objective = ADJOINT + wanted.objective
        # With this sign the multipliers of inequalities are positive where d mu_1 has reached its target.
        self.kappa = wanted.target * wanted.relaxation
        self.relaxed = bool(self.problem.names_of(Role.INEQUALITY))

    def run(self) -> Extremum:
        try:
            if self.relaxed:
                self._enter_feasible_set()
            self._find_fold()
            self._switch_branch()
            for name in self.wanted.parameters[self.wanted.n_first :]:
                self._release(name)
            if self.relaxed:
                self._tighten()
        except _Stuck as stuck:
            return self._result(converged=False, reason=str(stuck))
        return self._result(converged=True, reason="all derivatives of the objective vanish")

    def _system(self, *, nontrivial: bool, released: str | None = None) -> ExtendedSystem:
        """Fixed: parameters still held, multipliers of those released before, d mu_1 = 1 once it is reached."""
        u, held = self.problem.start, held_monitors(self.problem, (self.wanted.objective, *self.free, released or ""))
        fixed = {name: float(self.problem.stage(name).values(u)[0]) for name in held}
        fixed |= {ADJOINT + name: 0.0 for name in self.free}
        if nontrivial:
            fixed[self.d_objective] = self.wanted.target
        if self.relaxed and released != RELAXATION:
            fixed[RELAXATION] = self.kappa
        return ExtendedSystem(problem=self.problem, fixed=fixed, adjoint=True, objective=self.wanted.objective)

    def _enter_feasible_set(self) -> None:
        fixed = {
            k: v for k, v in self._system(nontrivial=False).fixed.items() if k in self.problem.names_of(Role.MONITOR)
        }
        start = feasible_start(self.method.path, self.problem, fixed, self.wanted.bounds)
        if not start.found:
            raise _Stuck(start.reason)
        self.problem = start.problem

    def _find_fold(self) -> None:
        system = self._system(nontrivial=False)
        x = system.first_point(kappa=self.kappa)
        better = self._uphill(system, x)
        paths: list[Path] = []
        for direction in (better, -better):
            paths.append(self._follow(system, x, direction, BranchPoint(stops=True)))
            if paths[-1].located("branch point"):
                self._add(f"fold of {self.wanted.objective}", paths[-1])
                return
        reasons = "; the other way: ".join(path.reason for path in paths)
        raise _Stuck(f"no fold of '{self.wanted.objective}' was found: {reasons}")

    def _uphill(self, system: ExtendedSystem, x: np.ndarray) -> np.ndarray:
        """Direction along the path, shape (n_x,), in which the objective improves."""
        gradient = system.parameter_gradient(x, self.wanted.objective)
        tangent = tangent_at(system, x, np.random.default_rng(0).normal(size=len(x)))
        if tangent is None:
            raise _Stuck("the start lies on no single path: its Jacobian has no full rank")
        return tangent * (-self.wanted.target if gradient @ tangent > 0.0 else self.wanted.target)

    def _switch_branch(self) -> None:
        point = self.stages[-1].point
        system = point.system
        assert isinstance(system, ExtendedSystem)  # The stage before made it.
        direction = branch_direction(system, point)
        share = 0.0 if direction is None else float(system.parameter_gradient(point.x, self.d_objective) @ direction)
        if direction is None or abs(share) <= NORMAL:
            raise _Stuck(
                "the multiplier of the objective vanishes on the new branch: the equations alone are dependent there"
            )
        # The branch is a straight line at fixed u: steps as long as the way need no control.
        way = abs(self.wanted.target / share)
        direction = direction * np.sign(share * self.wanted.target)
        method = replace(self.method.path, step=0.3 * way, max_step=way, max_points=20)
        first = switched(method, point, direction, 0.1 * way)
        if first is None:
            raise _Stuck("the branch of nontrivial multipliers cannot be entered")
        event = Crossing(parameter=self.d_objective, value=self.wanted.target, stops=True)
        self._add(event.name, method.follow(system, first.x, direction=direction, events=(event,)))

    def _release(self, name: str) -> None:
        """Let a parameter go until the derivative with respect to it vanishes."""
        parameter = ADJOINT + name
        system, x = self._restart(name)
        if abs(system.parameter(x, parameter)) <= NO_SIGN:
            # Extremal already. Its multiplier is fixed from here on, and the value stays free.
            self.free = (*self.free, name)
            return
        gradient = system.parameter_gradient(x, parameter)
        paths: list[Path] = []
        event = Crossing(parameter=parameter, stops=True)
        for sign in (1.0, -1.0):
            tangent = tangent_at(system, x, np.random.default_rng(0).normal(size=len(x)))
            if tangent is None:
                raise _Stuck(f"the extremum is no smooth function of '{name}' at the end of the stage before")
            falling = -np.sign(gradient @ tangent) * np.sign(system.parameter(x, parameter))
            paths.append(self._follow(system, x, sign * falling * tangent, event))
            if paths[-1].located(event.name):
                self._add(event.name, paths[-1])
                self.free = (*self.free, name)
                return
        reasons = "; the other way: ".join(path.reason for path in paths)
        raise _Stuck(f"d.{name} does not vanish: {reasons}")

    def _tighten(self) -> None:
        system, x = self._restart(RELAXATION)
        tangent = tangent_at(system, x, system.parameter_gradient(x, RELAXATION))
        if tangent is None:
            raise _Stuck("complementarity cannot be tightened: the extremum is no smooth function of kappa")
        event = Crossing(parameter=RELAXATION, stops=True)
        step = min(self.method.path.step, 0.1)
        path = replace(self.method.path, step=step).follow(
            system, x, direction=-self.wanted.target * tangent, events=(event,), bounds=dict(self.wanted.bounds)
        )
        self._add(event.name, path)

    def _restart(self, released: str) -> tuple[ExtendedSystem, np.ndarray]:
        """The next system, and the last point in its unknowns, shape (n_x,), carried over to a new mesh if wanted."""
        if self.wanted.remesh is None:
            return self._system(nontrivial=True, released=released), self.stages[-1].point.x
        self.problem = self.wanted.remesh(self.problem, self.problem.start)
        system = self._system(nontrivial=True, released=released)
        multipliers = estimated_multipliers(system, self.problem.start, self.kappa)
        if multipliers is None:
            raise _Stuck("the multipliers are not unique on the new mesh")
        x = self.method.path.correct(system, system.first_point(multipliers, self.kappa))
        if x is None:
            raise _Stuck("the extremum could not be carried over to the new mesh")
        return system, x

    def _follow(self, system: ExtendedSystem, x: np.ndarray, direction: np.ndarray, event: Event) -> Path:
        bounds = dict(self.wanted.bounds)
        return self.method.path.follow(system, x, direction=direction, events=(event,), bounds=bounds)

    def _add(self, name: str, path: Path) -> None:
        if not path.events:
            raise _Stuck(f"'{name}' was not reached: {path.reason}")
        point = path.events[-1]
        system = point.system
        assert isinstance(system, ExtendedSystem)  # Only these are followed here.
        objective = system.parameter(point.x, self.wanted.objective)
        self.stages.append(ExtremumStage(name=name, objective=objective, point=point, path=path))
        self.problem = system.problem.starting_at(system.unknowns(point.x))

    def _result(self, *, converged: bool, reason: str) -> Extremum:
        problem = self.problem
        values = {n: float(problem.stage(n).values(problem.start)[0]) for n in problem.names_of(Role.MONITOR)}
        if not self.stages:
            return Extremum(
                stages=(), system=None, x=problem.start, objective=values[self.wanted.objective], parameters=values,
                multipliers={}, curvature=np.zeros(0), residual=np.inf, converged=False, reason=reason,
            )  # fmt: skip
        point = self.stages[-1].point
        system = point.system
        assert isinstance(system, ExtendedSystem)  # Only these are followed here.
        residual = float(np.max(np.abs(system.residual(point.x))))
        scale = system.parameter(point.x, self.d_objective)
        names = [n for n in values if n != self.wanted.objective]
        # L = mu_1 + eta (psi - mu): at fixed mu the objective changes by -eta per unit of mu.
        sensitivity = {n: -system.parameter(point.x, ADJOINT + n) / scale if scale else np.nan for n in names}
        curvature = reduced_curvature(
            system, point.x, self.wanted.objective, held_monitors(problem, (self.wanted.objective, *self.free))
        )
        certified = residual <= self.method.certificate
        return Extremum(
            stages=tuple(self.stages),
            system=system,
            x=point.x,
            objective=values[self.wanted.objective],
            parameters=values,
            multipliers=sensitivity,
            curvature=np.zeros(0) if curvature is None else curvature,
            residual=residual,
            converged=converged and certified,
            reason=reason if certified or not converged else f"the residual {residual:.1e} is above the certificate",
        )
