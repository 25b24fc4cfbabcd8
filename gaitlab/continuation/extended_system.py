r"""Square-but-one systems whose solutions form a path: a problem, its adjoint equations and fixed parameters.

Unknowns X = (u, lambda, eta, kappa) without or with multipliers; equations

.. math::

    \phi(u) = 0, \quad \phi_u^T \lambda + \psi_u^T \eta_\psi + G_u^T \eta_G = 0, \quad
    -\eta_{G,j} G_j(u) = \kappa \, \eta_1, \quad \mu_i = const, \quad d\mu_i = const

for the parameters mu_i = psi_i(u) and d mu_i = eta_i that are fixed; the others are released. This is the optimality
system of Li, Anderson, Dankowicz (Table 1) minus the conditions eta_1 = 1, eta_2 = 0, which successive continuation
reaches one by one. The third equation relaxes complementarity, see `inequality`. The adjoint part is linear in the
multipliers, and X = (u, 0, 0, kappa) solves it for every u: the trivial branch.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import sparse

from ..errors import NotFound, ProblemError
from .inequality import Positions, Relaxation, complementarity_jacobian
from .staged_function import Entries, Role
from .zero_problem import ZeroProblem, joined

RELAXATION = "kappa"
"""Name of the parameter that relaxes complementarity."""
ADJOINT = "d."
"""The multiplier of the parameter 'mu' is the parameter 'd.mu'."""


class PathSystem(Protocol):
    """n - 1 equations in n unknowns, as `path_following` needs them."""

    @property
    def weights(self) -> np.ndarray:
        """Weights of the inner product, shape (n,)."""
        ...

    def residual(self, x: np.ndarray) -> np.ndarray:
        """Left-hand sides at x, shape (n,); result (n - 1,)."""
        ...

    def jacobian(self, x: np.ndarray) -> sparse.csr_matrix:
        """Their Jacobian at x, shape (n,); result (n - 1, n)."""
        ...

    def parameter(self, x: np.ndarray, name: str) -> float:
        """Value of a continuation parameter at x, shape (n,). Raises `errors.NotFound` for an unknown name."""
        ...

    def parameter_gradient(self, x: np.ndarray, name: str) -> np.ndarray:
        """Its gradient at x, shape (n,); result (n,)."""
        ...

    def parameter_names(self) -> tuple[str, ...]:
        """All names."""
        ...

    def refreshed(self, x: np.ndarray) -> "PathSystem":
        """The system with its moving references at x, shape (n,)."""
        ...

    def invalid_part(self, x: np.ndarray) -> str | None:
        """Name of a part that returns a number that is not finite at x, shape (n,)."""
        ...

    def admits(self, old: np.ndarray, new: np.ndarray) -> bool:
        """Whether a step from old to new, both of shape (n,), is short enough not to miss anything."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class ExtendedSystem:
    """A `PathSystem` made of a problem and the values of its fixed parameters."""

    problem: ZeroProblem
    fixed: Mapping[str, float] = field(default_factory=lambda: {})
    """Values of the parameters that do not change: 'mu', 'd.mu' or 'kappa'."""
    adjoint: bool = False
    """Whether the multipliers are unknowns."""
    objective: str | None = None
    """The monitor whose multiplier scales the relaxed complementarity."""

    def __post_init__(self) -> None:
        for name in self.fixed:
            self._require(name)
        if self._relaxed and self.objective not in self.problem.names_of(Role.MONITOR):
            raise ProblemError("inequalities need the name of the objective among the monitors")
        surplus = self.n_x - self.n_equations
        if surplus != 1:
            free = [name for name in self.parameter_names() if name not in self.fixed]
            advice = f"fix {surplus - 1} more of {free}" if surplus > 1 else f"release {1 - surplus} of {[*self.fixed]}"
            raise ProblemError(
                f"a path needs one more unknown than equations; here are {self.n_x} and {self.n_equations}: {advice}"
            )

    def _require(self, name: str) -> None:
        if name not in self.parameter_names():
            raise NotFound("continuation parameter", name, self.parameter_names())

    @property
    def _relaxed(self) -> bool:
        return self.adjoint and bool(self.problem.names_of(Role.INEQUALITY))

    @cached_property
    def n_x(self) -> int:
        """Number of unknowns."""
        return self.problem.n_u + (self.problem.n_rows + int(self._relaxed) if self.adjoint else 0)

    @cached_property
    def n_equations(self) -> int:
        """Number of equations."""
        inequalities = len(self.problem.names_of(Role.INEQUALITY)) if self.adjoint else 0
        return self.problem.n_zero + (self.problem.n_u if self.adjoint else 0) + inequalities + len(self.fixed)

    @property
    def weights(self) -> np.ndarray:
        """Weights of the inner product, shape (n_x,): those of the unknowns and of each stage's multipliers."""
        return self._weights

    @cached_property
    def _weights(self) -> np.ndarray:
        if not self.adjoint:
            return self.problem.weights
        multipliers = [np.full(f.n_rows, f.weight) for f in self.problem.ordered]
        return np.concatenate([self.problem.weights, *multipliers, np.ones(int(self._relaxed))])

    def parameter_names(self) -> tuple[str, ...]:
        """Monitors, their multipliers, those of the inequalities, and the relaxation."""
        return self._parameter_names

    @cached_property
    def _parameter_names(self) -> tuple[str, ...]:
        monitors = self.problem.names_of(Role.MONITOR)
        if not self.adjoint:
            return monitors
        bounded = (*monitors, *self.problem.names_of(Role.INEQUALITY))
        return (*monitors, *(ADJOINT + name for name in bounded), *([RELAXATION] if self._relaxed else []))

    def first_point(self, multipliers: np.ndarray | None = None, kappa: float = 0.0) -> np.ndarray:
        """X, shape (n_x,), at the start of the problem; multipliers, shape (n_rows,), are zero unless given."""
        if not self.adjoint:
            return self.problem.start.copy()
        multipliers = np.zeros(self.problem.n_rows) if multipliers is None else multipliers
        return np.concatenate([self.problem.start, multipliers, [kappa] if self._relaxed else []])

    def unknowns(self, x: np.ndarray) -> np.ndarray:
        """The part u of x, shape (n_x,); result (n_u,)."""
        return x[: self.problem.n_u]

    def multipliers(self, x: np.ndarray) -> np.ndarray:
        """Multipliers of all stages within x, shape (n_x,); result (n_rows,)."""
        return x[self.problem.n_u : self.problem.n_u + self.problem.n_rows]

    def parameter(self, x: np.ndarray, name: str) -> float:
        """Value of a continuation parameter at x, shape (n_x,)."""
        self._require(name)
        if name in self.problem.names_of(Role.MONITOR):
            return float(self.problem.stage(name).values(self.unknowns(x))[0])
        return float(x[self._position(name)])

    def parameter_gradient(self, x: np.ndarray, name: str) -> np.ndarray:
        """Gradient of a continuation parameter at x, shape (n_x,); result (n_x,)."""
        self._require(name)
        gradient = np.zeros(self.n_x)
        if name in self.problem.names_of(Role.MONITOR):
            entries = self.problem.stage(name).jacobian(self.unknowns(x))
            np.add.at(gradient, entries.cols, entries.values)
        else:
            gradient[self._position(name)] = 1.0
        return gradient

    def _position(self, name: str) -> int:
        if name == RELAXATION:
            return self.n_x - 1
        return self.problem.n_u + self.problem.rows[name.removeprefix(ADJOINT)].start

    def residual(self, x: np.ndarray) -> np.ndarray:
        """All equations at x, shape (n_x,); result (n_x - 1,)."""
        u, problem = self.unknowns(x), self.problem
        values = problem.values(u)
        parts = [values[: problem.n_zero]]
        if self.adjoint:
            parts.append(problem.adjoint(u, self.multipliers(x)))
        if self._relaxed:
            parts.append(self._relaxation(x, values).residual())
        parts.append(np.array([self.parameter(x, name) - value for name, value in self.fixed.items()]))
        return np.concatenate(parts)

    def jacobian(self, x: np.ndarray) -> sparse.csr_matrix:
        """Derivative of all equations at x, shape (n_x,); result (n_x - 1, n_x)."""
        u, problem = self.unknowns(x), self.problem
        J = problem.jacobian(u)
        parts = [_part(J, 0, problem.n_zero, 0)]
        if self.adjoint:
            parts.append(_moved(problem.adjoint_jacobian(u, self.multipliers(x)), problem.n_zero, 0))
            parts.append(_moved(Entries(J.cols, J.rows, J.values), problem.n_zero, problem.n_u))
        if self._relaxed:
            parts += self._complementarity_jacobian(x, J)
        first = self.n_equations - len(self.fixed)
        parts += [self._fixed_row(name, first + i, J) for i, name in enumerate(self.fixed)]
        rows, cols, values = joined(parts)
        return sparse.csr_matrix((values, (rows, cols)), shape=(self.n_equations, self.n_x))

    def _fixed_row(self, name: str, row: int, J: Entries) -> Entries:
        if name in self.problem.names_of(Role.MONITOR):
            source = self.problem.rows[name].start
            return _part(J, source, source + 1, row)
        return Entries(np.array([row]), np.array([self._position(name)]), np.ones(1))

    def _relaxation(self, x: np.ndarray, values: np.ndarray) -> Relaxation:
        rows = self._inequality_rows
        return Relaxation(values[rows], self.multipliers(x)[rows], float(x[-1]), float(x[self._objective_position]))

    def _complementarity_jacobian(self, x: np.ndarray, J: Entries) -> list[Entries]:
        rows, problem = self._inequality_rows, self.problem
        at = Positions(
            row=problem.n_zero + problem.n_u,
            sigma=problem.n_u + rows.start,
            d_objective=self._objective_position,
            kappa=self.n_x - 1,
        )
        point = self._relaxation(x, problem.values(self.unknowns(x)))
        return complementarity_jacobian(point, at, _part(J, rows.start, rows.stop, 0))

    @property
    def _inequality_rows(self) -> slice:
        return slice(self.problem.n_rows - len(self.problem.names_of(Role.INEQUALITY)), self.problem.n_rows)

    @property
    def _objective_position(self) -> int:
        return self._position(ADJOINT + str(self.objective))

    def refreshed(self, x: np.ndarray) -> "ExtendedSystem":
        """The system with its moving references at x, shape (n_x,)."""
        problem = self.problem.refreshed(self.unknowns(x))
        return self if problem is self.problem else replace(self, problem=problem)

    def admits(self, old: np.ndarray, new: np.ndarray) -> bool:
        """Whether no inequality comes more than ten times closer to its bound from old to new, shapes (n_x,).

        A longer step could pass a fold just before the bound and the bound itself, and see nothing of either. Where
        kappa changes its sign, active inequalities do so too.
        """
        if not self._relaxed or old[-1] * new[-1] < 0.0:
            return True
        before, after = (self.problem.values(self.unknowns(x))[self._inequality_rows] for x in (old, new))
        return bool(np.all(after <= 0.1 * before))

    def invalid_part(self, x: np.ndarray) -> str | None:
        """Name of the first stage that returns a number that is not finite at x, shape (n_x,)."""
        part = self.problem.not_finite(self.unknowns(x))
        return part if part or np.all(np.isfinite(self.residual(x))) else "adjoint equations"


def _part(entries: Entries, first: int, last: int, to: int) -> Entries:
    """Rows first to last - 1 of a matrix, moved to begin at row `to`."""
    kept = (entries.rows >= first) & (entries.rows < last)
    return Entries(entries.rows[kept] - first + to, entries.cols[kept], entries.values[kept])


def _moved(entries: Entries, down: int, right: int) -> Entries:
    return Entries(entries.rows + down, entries.cols + right, entries.values)
