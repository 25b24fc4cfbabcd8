"""Problems built stage by stage, and whole problems glued from smaller ones.

A problem has unknowns u, equations phi(u) = 0, monitor functions mu = psi(u) whose values are continuation parameters,
and inequalities G(u) <= 0 (Dankowicz and Schilder, Recipes for Continuation, SIAM 2013, ch. 2-5). Every stage carries
its part of the adjoint equations, so that any problem that can be composed can be optimised (Li, Anderson, Dankowicz).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np

from ..errors import NotFound, ProblemError
from .staged_function import BlockFunction, Entries, PickedUnknown, Role, Stage, StagedFunction

Where = str | np.ndarray
"""Unknowns: the name of variables, or indices into u, shape (n,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ZeroProblem:
    """Unknowns and stages. Every `add_...` returns a larger problem and leaves this one as it is."""

    start: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Values of the unknowns to start from, shape (n_u,)."""
    weights: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Weight of each unknown in the length of a path, shape (n_u,)."""
    names: Mapping[str, slice] = field(default_factory=lambda: {})
    """Where the named variables lie in u."""
    functions: tuple[Stage, ...] = ()

    @property
    def n_u(self) -> int:
        """Number of unknowns."""
        return len(self.start)

    def indices(self, where: Where) -> np.ndarray:
        """Indices into u of named variables, shape (n,). Raises `NotFound` for an unknown name."""
        if not isinstance(where, str):
            if where.size and (where.min() < 0 or where.max() >= self.n_u):
                raise ProblemError(f"indices must lie within 0 and {self.n_u - 1}, got {where}")
            return where
        if where not in self.names:
            raise NotFound("variable", where, self.names)
        return np.arange(self.n_u)[self.names[where]]

    def add_variables(self, name: str, start: np.ndarray, weight: float = 1.0) -> "ZeroProblem":
        """Add unknowns with their start values, shape (n,)."""
        start = np.atleast_1d(np.asarray(start, dtype=float))
        if name in self.names or start.ndim != 1 or not np.all(np.isfinite(start)):
            raise ProblemError(f"variables '{name}' need a new name and a finite vector, got shape {start.shape}")
        return replace(
            self,
            start=np.concatenate([self.start, start]),
            weights=np.concatenate([self.weights, np.full(len(start), weight)]),
            names={**self.names, name: slice(self.n_u, self.n_u + len(start))},
        )

    def add_function(self, function: Stage) -> "ZeroProblem":
        """Add a stage made of blocks. Raises `ProblemError` where its name is taken or an index is out of range."""
        if function.name in {f.name for f in self.functions}:
            raise ProblemError(f"there is a stage '{function.name}' already")
        if function.role is not Role.ZERO and function.n_rows != 1:
            raise ProblemError(f"'{function.name}' must be one number, got {function.n_rows}")
        self.indices(function.inputs.ravel())
        return replace(self, functions=(*self.functions, function))

    def add_zero(self, name: str, expression: Callable[..., ca.SX], *where: Where) -> "ZeroProblem":
        """Add equations expression(v1, v2, ...) = 0 of some variables, given as CasADi vectors."""
        return self.add_function(self._stage(name, expression, where, Role.ZERO))

    def add_monitor(self, name: str, expression: Callable[..., ca.SX], *where: Where) -> "ZeroProblem":
        """Add a continuation parameter mu = expression(v1, v2, ...)."""
        return self.add_function(self._stage(name, expression, where, Role.MONITOR))

    def add_inequality(self, name: str, expression: Callable[..., ca.SX], *where: Where) -> "ZeroProblem":
        """Add an inequality expression(v1, v2, ...) <= 0."""
        return self.add_function(self._stage(name, expression, where, Role.INEQUALITY))

    def add_parameters(self, names: tuple[str, ...], where: Where) -> "ZeroProblem":
        """Make each of some unknowns a continuation parameter of its own name."""
        indices = self.indices(where)
        if len(indices) != len(names):
            raise ProblemError(f"{len(indices)} parameters need as many names, got {names}")
        problem = self
        for name, index in zip(names, indices, strict=True):
            problem = problem.add_function(PickedUnknown(name=name, index=int(index)))
        return problem

    def embed(self, name: str, other: "ZeroProblem") -> "ZeroProblem":
        """Add a whole problem; its variables and stages are called 'name.variable' and 'name.stage' here."""
        problem = replace(
            self,
            start=np.concatenate([self.start, other.start]),
            weights=np.concatenate([self.weights, other.weights]),
            names={**self.names, **{f"{name}.{k}": _shifted(v, self.n_u) for k, v in other.names.items()}},
        )
        if len(problem.names) != len(self.names) + len(other.names):
            raise ProblemError(f"there is a problem '{name}' already")
        for function in other.functions:
            problem = problem.add_function(function.moved(name, self.n_u))
        return problem

    def starting_at(self, u: np.ndarray) -> "ZeroProblem":
        """The same problem with other start values, shape (n_u,)."""
        if u.shape != self.start.shape:
            raise ProblemError(f"the start must have shape {self.start.shape}, got {u.shape}")
        return replace(self, start=u.copy())

    def refreshed(self, u: np.ndarray) -> "ZeroProblem":
        """The problem with its moving references at u, shape (n_u,)."""
        functions = tuple(f.refreshed(u) for f in self.functions)
        return self if functions == self.functions else replace(self, functions=functions)

    def _stage(
        self, name: str, expression: Callable[..., ca.SX], where: tuple[Where, ...], role: Role
    ) -> StagedFunction:
        groups = [self.indices(w) for w in where]
        symbols = [ca.SX.sym(f"v{i}", len(group)) for i, group in enumerate(groups)]
        try:
            r = ca.vec(ca.SX(expression(*symbols)))
        except (TypeError, NotImplementedError, RuntimeError, IndexError) as error:
            sizes = [len(group) for group in groups]
            raise ProblemError(
                f"stage '{name}' is no CasADi expression of vectors of sizes {sizes}: {error}"
            ) from error
        block = BlockFunction(ca.vertcat(*symbols), r)
        return StagedFunction(
            name=name,
            block=block,
            inputs=np.concatenate(groups)[None],
            outputs=np.arange(block.n_out)[None],
            data=np.zeros((1, 0)),
            role=role,
        )

    @cached_property
    def ordered(self) -> tuple[Stage, ...]:
        """Stages in the order of the rows: equations, monitors, inequalities."""
        return tuple(f for role in Role for f in self.functions if f.role is role)

    @cached_property
    def rows(self) -> Mapping[str, slice]:
        """Rows of each stage among all, and of its multipliers."""
        ends = np.cumsum([0, *(f.n_rows for f in self.ordered)])
        return {f.name: slice(int(a), int(b)) for f, a, b in zip(self.ordered, ends[:-1], ends[1:], strict=True)}

    def names_of(self, role: Role) -> tuple[str, ...]:
        """Names of the stages of one role, in the order of their rows."""
        return self._names_by_role[role]

    @cached_property
    def _names_by_role(self) -> Mapping[Role, tuple[str, ...]]:
        return {role: tuple(f.name for f in self.ordered if f.role is role) for role in Role}

    def stage(self, name: str) -> Stage:
        """The stage of this name. Raises `NotFound` for an unknown one."""
        if name not in self._by_name:
            raise NotFound("stage", name, self._by_name)
        return self._by_name[name]

    @cached_property
    def _by_name(self) -> Mapping[str, Stage]:
        return {f.name: f for f in self.functions}

    @cached_property
    def n_zero(self) -> int:
        """Number of equations."""
        return sum(f.n_rows for f in self.functions if f.role is Role.ZERO)

    @cached_property
    def n_rows(self) -> int:
        """Number of equations, monitors and inequalities."""
        return sum(f.n_rows for f in self.functions)

    def values(self, u: np.ndarray) -> np.ndarray:
        """Values of all stages at u, shape (n_u,); result (n_rows,)."""
        return np.concatenate([np.zeros(0), *(f.values(u) for f in self.ordered)])

    def jacobian(self, u: np.ndarray) -> Entries:
        """Jacobian of all stages at u, shape (n_u,); matrix of shape (n_rows, n_u)."""
        return joined([_down(f.jacobian(u), self.rows[f.name].start) for f in self.ordered])

    def adjoint(self, u: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """J' l at u, shape (n_u,), for multipliers of shape (n_rows,): the adjoint equations; result (n_u,)."""
        parts = [f.adjoint(u, multipliers[self.rows[f.name]]) for f in self.ordered]
        return np.sum([np.zeros(self.n_u), *parts], axis=0)

    def adjoint_jacobian(self, u: np.ndarray, multipliers: np.ndarray) -> Entries:
        """Derivative of J' l in u, shape (n_u,), for multipliers of shape (n_rows,); matrix of shape (n_u, n_u)."""
        return joined([f.adjoint_jacobian(u, multipliers[self.rows[f.name]]) for f in self.ordered])

    def not_finite(self, u: np.ndarray) -> str | None:
        """Name of the first stage that returns a number that is not finite at u, shape (n_u,)."""
        return next((f.name for f in self.ordered if not np.all(np.isfinite(f.values(u)))), None)


def _shifted(part: slice, offset: int) -> slice:
    return slice(part.start + offset, part.stop + offset)


def _down(entries: Entries, offset: int) -> Entries:
    return entries._replace(rows=entries.rows + offset)


def joined(parts: list[Entries]) -> Entries:
    """Sum of sparse matrices of the same shape."""
    none = Entries(np.zeros(0, dtype=int), np.zeros(0, dtype=int), np.zeros(0))
    rows, cols, values = (np.concatenate(arrays) for arrays in zip(none, *parts, strict=True))
    return Entries(rows, cols, values)
