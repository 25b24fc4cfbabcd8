"""Multi-stage optimal control problems."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import casadi as ca
import numpy as np

from ..errors import NotFound, ProblemError
from .constraint import Bounds, Point, PointConstraint
from .cost import criterion_names
from .stage import Stage
from .symbols import element_names, require_known, require_shape, require_symbols
from .transition import Transition


def _nothing() -> ca.SX:
    return ca.SX(0, 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class MultiStageProblem:
    r"""Lower level of an inverse problem, or an optimal control problem of its own (Hatz 2014, (4.6)).

    .. math::

        \underset{x, u, q}{\text{minimize}} \; \sum_i \theta_i \sum_k \Big( \phi_{ki}(x_k(T_k); q, p) +
        \int_0^{T_k} \ell_{ki}(t, x_k, u_k; q, p) \, dt \Big)

    subject to each stage's equations and constraints, the transitions between stages, and point constraints.
    Without criteria, and with the parameters freed, it is an ordinary parameter estimation problem.

    Raises:
        ProblemError: Shapes do not fit, or an expression uses symbols that it may not use.
    """

    stages: tuple[Stage, ...]
    transitions: tuple[Transition, ...] = ()
    """One between each two neighbouring stages."""
    q: ca.SX = field(default_factory=_nothing)
    """Control values: unknowns that do not depend on time, for instance durations; symbols of shape (n_q, 1)."""
    q_bounds: Bounds | None = None
    p: ca.SX = field(default_factory=_nothing)
    """Parameters, given when the problem is solved; symbols of shape (n_p, 1)."""
    points: tuple[PointConstraint, ...] = ()

    def __post_init__(self) -> None:
        if not self.stages:
            raise ProblemError("a problem needs at least one stage")
        require_symbols("q", self.q)
        require_symbols("p", self.p)
        if self.q_bounds is not None and self.q_bounds.size != self.q.numel():
            raise ProblemError(f"q_bounds must have size {self.q.numel()}, got {self.q_bounds.size}")
        if len(set(self.parameter_names)) != len(self.parameter_names):
            raise ProblemError(f"criteria and parameters need different names, got {', '.join(self.parameter_names)}")
        for stage in self.stages:
            stage.check(self.q, self.p)
        self._check_transitions()
        for constraint in self.points:
            self.check_point_constraint(constraint)

    @property
    def criteria(self) -> tuple[str, ...]:
        """Names of the criteria in the order of their weights theta."""
        return criterion_names(self.stages)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the criteria, which stand for their weights, and of the parameters: (theta, p)."""
        return (*self.criteria, *element_names(self.p))

    @property
    def control_value_bounds(self) -> Bounds:
        """Bounds on q."""
        return self.q_bounds or Bounds.none(self.q.numel())

    def point(self, time: float, stage: int = 0) -> Point:
        """New point at a fraction of a stage's duration, for use in a point constraint."""
        self._require_stage(stage)
        chosen = self.stages[stage]
        x, u = ca.SX.sym(f"x_at_{time:g}", chosen.n_x), ca.SX.sym(f"u_at_{time:g}", chosen.n_u)
        return Point(stage=stage, time=time, x=x, u=u)

    def with_points(self, *constraints: PointConstraint) -> "MultiStageProblem":
        """Return the same problem with more point constraints."""
        return replace(self, points=(*self.points, *constraints))

    def with_free_parameters(self, bounds: Bounds) -> "MultiStageProblem":
        """Return the same problem with the parameters p among the unknowns q: one-level parameter estimation."""
        q_bounds = self.control_value_bounds
        both = Bounds(lower=np.append(q_bounds.lower, bounds.lower), upper=np.append(q_bounds.upper, bounds.upper))
        return replace(self, q=ca.vertcat(self.q, self.p), q_bounds=both, p=ca.SX(0, 1))

    def parameters(self, values: Mapping[str, float]) -> np.ndarray:
        """The vector (theta, p) from numbers by name, shape (n_theta + n_p,).

        Raises:
            NotFound: A name is neither a criterion nor a parameter.
            ProblemError: A number is missing.
        """
        names = self.parameter_names
        for name in values:
            self.parameter_index(name)
        missing = [name for name in names if name not in values]
        if missing:
            raise ProblemError(f"no value is given for {', '.join(missing)}")
        return np.array([values[name] for name in names], dtype=float)

    def parameter_index(self, name: str) -> int:
        """Place of a criterion's weight or of a parameter in (theta, p)."""
        if name not in self.parameter_names:
            raise NotFound("criterion or parameter", name, self.parameter_names)
        return self.parameter_names.index(name)

    def _check_transitions(self) -> None:
        if len(self.transitions) != len(self.stages) - 1:
            raise ProblemError(f"{len(self.stages)} stages need {len(self.stages) - 1} transitions, "
                               f"got {len(self.transitions)}")  # fmt: skip
        for transition, before, after in zip(self.transitions, self.stages, self.stages[1:], strict=False):
            what = f"the transition from stage '{before.name}' to '{after.name}'"
            require_shape(what, transition.next_state, after.x.shape)
            require_known(what, transition.next_state, (before.x, self.q, self.p))

    def check_point_constraint(self, constraint: PointConstraint) -> None:
        """Raise `errors.ProblemError` where a point constraint does not belong to the problem."""
        name, symbols = constraint.constraint.name, [self.q, self.p]
        for point in constraint.points:
            self._require_stage(point.stage)
            chosen = self.stages[point.stage]
            require_shape(f"x of a point of '{name}'", point.x, chosen.x.shape)
            symbols += [point.x, point.u]
        require_known(f"point constraint '{name}'", constraint.constraint.expression, symbols)

    def _require_stage(self, stage: int) -> None:
        if not 0 <= stage < len(self.stages):
            raise ProblemError(f"stage {stage} does not exist; there are {len(self.stages)}")
