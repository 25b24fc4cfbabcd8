"""One interval of a stage as CasADi functions of its unknowns."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..ocp.cost import lagrange_terms, mayer_terms
from ..ocp.problem import MultiStageProblem
from ..ocp.stage import Stage
from .control_shapes import ControlShape
from .schemes import Ends, Scheme


@dataclass(frozen=True, kw_only=True, eq=False)
class StageModel:
    """Functions (z, d, parameters) of one interval, with d = (start, width), fractions of the stage.

    z is a row of `layout.StageLayout.interval`, parameters are (theta, p).
    """

    interval: ca.Function
    """-> (share of the objective, (defects, path constraints, inner control values))."""
    n_defects: int
    n_path: int
    """Path constraints of one interval in all."""
    end_path: ca.Function
    """-> (0, path constraints at the end of the interval)."""
    at_left: ca.Function
    """-> (t, x, u) at the left node."""
    at_right: ca.Function
    """-> (t, x, u) at the right node, the control from the left."""
    inside: ca.Function
    """The same at the fraction s of the interval, with d = (start, width, s)."""
    mayer: ca.Function
    """(x, q) at the end of the stage, no d -> (share of the objective, nothing)."""
    duration: ca.Function
    """(q, p) -> duration [s]."""


def model_stage(problem: MultiStageProblem, stage: Stage, scheme: Scheme, shape: ControlShape) -> StageModel:
    """Discretise a typical interval of a stage."""
    return _Builder(problem, stage, scheme, shape).build()


class _Builder:
    def __init__(self, problem: MultiStageProblem, stage: Stage, scheme: Scheme, shape: ControlShape) -> None:
        self.problem, self.stage, self.scheme, self.shape = problem, stage, scheme, shape
        self.theta = ca.SX.sym("theta", len(problem.criteria))
        self.parameters = ca.vertcat(self.theta, problem.p)
        self.x = Ends(
            ca.SX.sym("left", stage.n_x), ca.SX.sym("inside", stage.n_x, scheme.n_inside), ca.SX.sym("right", stage.n_x)
        )
        self.c_left = ca.SX.sym("c_left", stage.n_u, shape.per_node)
        self.c_right = ca.SX.sym("c_right", stage.n_u, shape.per_node)
        parts = [self.x.left, ca.vec(self.c_left), ca.vec(self.x.inside), self.x.right]
        self.z = ca.vertcat(*parts, *([ca.vec(self.c_right)] if shape.joined else []), problem.q)
        self.start, self.width = ca.SX.sym("start"), ca.SX.sym("width")
        self.duration = ca.SX(stage.duration)
        arguments = [stage.t, stage.x, stage.u, problem.q, problem.p]
        self.ode = ca.Function("ode", arguments, [stage.ode])
        self.running = ca.Function("running", arguments, [lagrange_terms(stage, problem.criteria)])
        self.path = ca.Function("path", arguments, [stage.path.bounded().expression])

    def build(self) -> StageModel:
        discretised = self.scheme.discretise(self._rhs, self.x)
        integrals = ca.SX.zeros(len(self.problem.criteria))
        if self.stage.lagrange:
            for sample in discretised.samples:
                integrals += sample.weight * self._scale() * self.running(*self._arguments(sample.s, sample.x))
        path = ca.vertcat(ca.SX(0, 1), *[self._path_at(s) for s in self._path_times()])
        bounded = np.flatnonzero(self.stage.control_bounds.finite).tolist()
        inner = ca.vec(self.shape.inner(self.c_left, self.c_right, self.width)[:, bounded].T)
        g = ca.vertcat(discretised.defects, path, inner)
        end_path = self.path(*self._arguments(ca.SX(1), self.x.right)) if self._has_path() else ca.SX(0, 1)
        s = ca.SX.sym("s")
        return StageModel(
            interval=self._function("interval", [ca.dot(self.theta, integrals), g]),
            n_defects=discretised.defects.numel(),
            n_path=path.numel(),
            end_path=self._function("end_path", [ca.SX(0), end_path]),
            at_left=self._function("at_left", self._arguments(ca.SX(0), self.x.left)[:3]),
            at_right=self._function("at_right", self._arguments(ca.SX(1), self.x.right)[:3]),
            inside=self._function("inside", self._inside(s), s),
            mayer=self._mayer(),
            duration=ca.Function("duration", [self.problem.q, self.problem.p], [self.duration]),
        )

    def _function(self, name: str, outputs: list[ca.SX], *more: ca.SX) -> ca.Function:
        d = ca.vertcat(self.start, self.width, *more)
        return ca.Function(name, [self.z, d, self.parameters], ca.cse([ca.densify(each) for each in outputs]))

    def _scale(self) -> ca.SX:
        return self.duration * self.width

    def _control(self, s: ca.SX) -> ca.SX:
        return self.shape.value(self.c_left, self.c_right, s, self.width)

    def _arguments(self, s: ca.SX, x: ca.SX) -> list[ca.SX]:
        time = self.duration * (self.start + self.width * s)
        return [time, x, self._control(s), self.problem.q, self.problem.p]

    def _rhs(self, s: ca.SX, x: ca.SX) -> ca.SX:
        return self._scale() * self.ode(*self._arguments(s, x))

    def _has_path(self) -> bool:
        return self.path.numel_out(0) > 0

    def _path_times(self) -> tuple[float, ...]:
        return self.scheme.path_times if self._has_path() else ()

    def _path_at(self, s: float) -> ca.SX:
        known = dict(zip(self.scheme.inside_times(), ca.horzsplit(self.x.inside), strict=True))
        x = self.x.left if s == 0.0 else known[s] if s in known else self.scheme.state(self._rhs, self.x, ca.SX(s))
        return self.path(*self._arguments(ca.SX(s), x))

    def _inside(self, s: ca.SX) -> list[ca.SX]:
        return self._arguments(s, self.scheme.state(self._rhs, self.x, s))[:3]

    def _mayer(self) -> ca.Function:
        z, none = ca.vertcat(self.stage.x, self.problem.q), ca.SX.sym("d", 0)
        terms = mayer_terms(self.stage, self.problem.criteria)
        return ca.Function("mayer", [z, none, self.parameters], [ca.dot(self.theta, terms), ca.SX(0, 1)])
