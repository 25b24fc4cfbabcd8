"""One stage of a problem: a function of some unknowns, and at the same time all it adds to the adjoint equations.

With multipliers l, a stage r(z) = 0 adds the column block J' of the adjoint equations J' l = 0 (Li, Anderson,
Dankowicz, "Embedded construction of adjoint equations for optimization using continuation", the matrix J). Newton's
method on the joint system needs the derivative of J' l too: the Hessian of l . r. CasADi derives both from the one
expression of r.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import NamedTuple, Protocol

import casadi as ca
import numpy as np

from ..errors import ProblemError


class Role(StrEnum):
    """What a stage means."""

    ZERO = "equation: its values vanish"
    MONITOR = "monitor: its value is a continuation parameter"
    INEQUALITY = "inequality: its value is not positive"


class Entries(NamedTuple):
    """Entries of a sparse matrix; repeated positions are summed."""

    rows: np.ndarray
    """Row of each entry, shape (nnz,)."""
    cols: np.ndarray
    """Column of each entry, shape (nnz,)."""
    values: np.ndarray
    """Entries, shape (nnz,)."""


class Stage(Protocol):
    """What a problem needs to know about one of its stages."""

    @property
    def name(self) -> str:
        """Its name, unique in the problem."""
        ...

    @property
    def role(self) -> Role:
        """What it means."""
        ...

    @property
    def n_rows(self) -> int:
        """Number of its equations."""
        ...

    @property
    def inputs(self) -> np.ndarray:
        """Which unknowns it sees, shape (n_copies, n_in)."""
        ...

    @property
    def data(self) -> np.ndarray:
        """What else it sees, shape (n_copies, n_d)."""
        ...

    @property
    def weight(self) -> float:
        """Weight of each of its multipliers in the length of a path."""
        ...

    def values(self, u: np.ndarray) -> np.ndarray:
        """Values at the unknowns u, shape (n_u,); result (n_rows,)."""
        ...

    def jacobian(self, u: np.ndarray) -> Entries:
        """Jacobian at u, shape (n_u,); matrix of shape (n_rows, n_u)."""
        ...

    def adjoint(self, u: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """J' l at u, shape (n_u,), for multipliers of shape (n_rows,); result (n_u,)."""
        ...

    def adjoint_jacobian(self, u: np.ndarray, multipliers: np.ndarray) -> Entries:
        """Derivative of J' l in u, shape (n_u,), for multipliers of shape (n_rows,); matrix of shape (n_u, n_u)."""
        ...

    def refreshed(self, u: np.ndarray) -> "Stage":
        """The stage with its references moved to u, shape (n_u,)."""
        ...

    def moved(self, prefix: str, offset: int) -> "Stage":
        """The same stage inside a larger problem."""
        ...


class BlockFunction:
    """r(z, d) with z of shape (n_in,), data d (n_d,), r (n_out,), and its first and second derivatives."""

    def __init__(self, z: ca.SX, r: ca.SX, d: ca.SX | None = None) -> None:
        """Derive everything from the expression r. Raises `ProblemError` where r is no function of z and d."""
        d = ca.SX(0, 1) if d is None else d
        self.n_in, self.n_out, self.n_d = z.numel(), r.numel(), d.numel()
        multipliers = ca.SX.sym("l", self.n_out)
        hessian, adjoint = ca.hessian(ca.dot(multipliers, r), z)
        try:
            self.values = ca.Function("r", [z, d], [ca.densify(r)])
            self.jacobian = ca.Function("J", [z, d], [ca.densify(ca.jacobian(r, z))])
            self.adjoint = ca.Function("adjoint", [z, d, multipliers], [ca.densify(adjoint)])
            self.adjoint_jacobian = ca.Function("H", [z, d, multipliers], [ca.densify(hessian)])
        except RuntimeError as error:
            raise ProblemError(f"a stage must depend on its own arguments only: {error}") from error


@dataclass(frozen=True, kw_only=True, eq=False)
class StagedFunction:
    """A block function applied to one or many groups of unknowns."""

    name: str
    block: BlockFunction
    inputs: np.ndarray
    """Which unknowns each copy sees, shape (n_copies, n_in)."""
    outputs: np.ndarray
    """Row of each output, shape (n_copies, n_out); outputs of one row are summed (integrals)."""
    data: np.ndarray
    """What else each copy sees, shape (n_copies, n_d)."""
    role: Role = Role.ZERO
    weight: float = 1.0
    """Weight of each of its multipliers in the length of a path."""
    refresh: Callable[[np.ndarray], np.ndarray] | None = None
    """New data, shape (n_copies, n_d), from the unknowns each copy sees, shape (n_copies, n_in): moving references."""

    def __post_init__(self) -> None:
        n_copies = len(self.inputs)
        wanted = {
            "inputs": (self.inputs.shape, (n_copies, self.block.n_in)),
            "outputs": (self.outputs.shape, (n_copies, self.block.n_out)),
            "data": (self.data.shape, (n_copies, self.block.n_d)),
        }
        for what, (found, shape) in wanted.items():
            if found != shape:
                raise ProblemError(f"{what} of stage '{self.name}' must have shape {shape}, got {found}")

    @property
    def n_rows(self) -> int:
        """Number of equations."""
        return self._n_rows

    @cached_property
    def _n_rows(self) -> int:
        return int(self.outputs.max(initial=-1)) + 1

    @cached_property
    def _mapped(self) -> dict[str, ca.Function]:
        b, n = self.block, len(self.inputs)
        return {f.name(): f.map(n) for f in (b.values, b.jacobian, b.adjoint, b.adjoint_jacobian)}

    def values(self, u: np.ndarray) -> np.ndarray:
        """Values at the unknowns u, shape (n_u,); result (n_rows,)."""
        out = self._call("r", u)
        return np.bincount(self.outputs.T.ravel(), weights=out.ravel(), minlength=self.n_rows)

    def jacobian(self, u: np.ndarray) -> Entries:
        """Jacobian at u, shape (n_u,); matrix of shape (n_rows, n_u)."""
        n_copies, n_in, n_out = len(self.inputs), self.block.n_in, self.block.n_out
        values = self._call("J", u).reshape(n_out, n_copies, n_in)
        rows = np.broadcast_to(self.outputs.T[:, :, None], values.shape)
        cols = np.broadcast_to(self.inputs[None], values.shape)
        return Entries(rows.ravel(), cols.ravel(), values.ravel())

    def adjoint(self, u: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """J' l at u, shape (n_u,), for multipliers of shape (n_rows,); result (n_u,)."""
        out = self._call("adjoint", u, multipliers)
        return np.bincount(self.inputs.T.ravel(), weights=out.ravel(), minlength=len(u))

    def adjoint_jacobian(self, u: np.ndarray, multipliers: np.ndarray) -> Entries:
        """Derivative of J' l in u, shape (n_u,), for multipliers of shape (n_rows,); matrix of shape (n_u, n_u)."""
        n_copies, n_in = self.inputs.shape
        values = self._call("H", u, multipliers).reshape(n_in, n_copies, n_in)
        rows = np.broadcast_to(self.inputs.T[:, :, None], values.shape)
        cols = np.broadcast_to(self.inputs[None], values.shape)
        return Entries(rows.ravel(), cols.ravel(), values.ravel())

    def refreshed(self, u: np.ndarray) -> "StagedFunction":
        """The stage with its references moved to u, shape (n_u,)."""
        return self if self.refresh is None else replace(self, data=self.refresh(u[self.inputs]))

    def moved(self, prefix: str, offset: int) -> "StagedFunction":
        """The same stage inside a larger problem."""
        return replace(self, name=f"{prefix}.{self.name}", inputs=self.inputs + offset)

    def _call(self, which: str, u: np.ndarray, multipliers: np.ndarray | None = None) -> np.ndarray:
        arguments = [u[self.inputs].T, self.data.T]
        if multipliers is not None:
            arguments.append(multipliers[self.outputs].T)
        return np.asarray(self._mapped[which](*arguments))


@dataclass(frozen=True, kw_only=True)
class PickedUnknown:
    """The monitor mu = u_i: by far the most frequent one, and no work for CasADi."""

    name: str
    index: int
    role: Role = Role.MONITOR
    n_rows: int = 1
    weight: float = 1.0

    @property
    def inputs(self) -> np.ndarray:
        """The one unknown it sees, shape (1, 1)."""
        return np.array([[self.index]])

    @property
    def data(self) -> np.ndarray:
        """Nothing, shape (1, 0)."""
        return np.zeros((1, 0))

    def values(self, u: np.ndarray) -> np.ndarray:
        """Value at u, shape (n_u,); result (1,)."""
        return u[self.index : self.index + 1]

    def jacobian(self, u: np.ndarray) -> Entries:
        """One at its place; u of shape (n_u,), matrix (1, n_u)."""
        del u  # Unused.
        return Entries(np.zeros(1, dtype=int), np.array([self.index]), np.ones(1))

    def adjoint(self, u: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """The multiplier, shape (1,), at its place; result (n_u,)."""
        result = np.zeros(len(u))
        result[self.index] = multipliers[0]
        return result

    def adjoint_jacobian(self, u: np.ndarray, multipliers: np.ndarray) -> Entries:
        """Nothing: the stage is linear in u, shape (n_u,), whatever the multipliers, shape (1,)."""
        del u, multipliers  # Unused.
        return Entries(np.zeros(0, dtype=int), np.zeros(0, dtype=int), np.zeros(0))

    def refreshed(self, u: np.ndarray) -> "PickedUnknown":
        """The stage itself, whatever u, shape (n_u,)."""
        del u  # Unused.
        return self

    def moved(self, prefix: str, offset: int) -> "PickedUnknown":
        """The same stage inside a larger problem."""
        return replace(self, name=f"{prefix}.{self.name}", index=self.index + offset)
