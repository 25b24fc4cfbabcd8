r"""Trajectories as stages of a problem: collocation, boundary conditions, periodicity, integrals.

A segment is a trajectory x(tau), tau in [0, 1], of duration T and parameters p with x' = T f(T tau, x, p). Its
unknowns are the values at the base points of a mesh, so that continuity holds by construction; at the Gauss points
the differential equation holds, weighted by the quadrature:

.. math::

    w_k h_i \left( \dot x(\tau_{ik}) - T f(T \tau_{ik}, x(\tau_{ik}), p) \right) = 0

With these weights the multiplier of a row is the value of lambda_1 at its Gauss point (Table 1 of Li, Anderson,
Dankowicz). Collocation at m Gauss points converges with order 2 m at the knots and m + 1 between (de Boor, Swartz,
SIAM J. Numer. Anal. 10, 1973). Discretisation and adjoint commute here: the adjoint equations are those of the
discretised problem.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from ..errors import ProblemError
from .collocation_mesh import Mesh
from .staged_function import BlockFunction, Role, StagedFunction
from .zero_problem import ZeroProblem

Field = Callable[[ca.SX, ca.SX, ca.SX], ca.SX]
"""f(t, x, p): time, state, parameters."""
EndCondition = Callable[[ca.SX, ca.SX, ca.SX, ca.SX], ca.SX]
"""Psi(x(0), x(T), T, p)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Segment:
    """One trajectory of a problem: unknowns 'name.x', 'name.T', 'name.p', equations 'name.collocation'."""

    name: str
    mesh: Mesh
    field: Field
    n_x: int
    n_p: int

    def add_to(self, problem: ZeroProblem, x: np.ndarray, duration: float, p: np.ndarray) -> ZeroProblem:
        """Add the segment, starting from states x at the base points, shape (n_points, n_x), and p, shape (n_p,)."""
        if x.shape != (self.mesh.n_points, self.n_x) or p.shape != (self.n_p,):
            raise ProblemError(
                f"segment '{self.name}' needs states of shape {(self.mesh.n_points, self.n_x)} and parameters of shape "
                f"{(self.n_p,)}, got {x.shape} and {p.shape}"
            )
        problem = problem.add_variables(f"{self.name}.x", x.ravel(), weight=1.0 / self.mesh.n_points)
        problem = problem.add_variables(f"{self.name}.T", np.array([duration]))
        problem = problem.add_variables(f"{self.name}.p", p)
        rows = self.mesh.degree * self.n_x
        return problem.add_function(
            StagedFunction(
                name=f"{self.name}.collocation",
                block=self._collocation(),
                inputs=self._inputs(problem),
                outputs=np.arange(self.mesh.n_intervals * rows).reshape(-1, rows),
                data=self._places(),
                weight=1.0 / self.mesh.n_points,
            )
        )

    def add_ends(self, problem: ZeroProblem, name: str, condition: EndCondition, role: Role = Role.ZERO) -> ZeroProblem:
        """Add a stage Psi(x(0), x(T), T, p): conditions, a monitor or an inequality."""
        where = (self.first(problem), self.last(problem), f"{self.name}.T", f"{self.name}.p")
        add = {Role.ZERO: problem.add_zero, Role.MONITOR: problem.add_monitor, Role.INEQUALITY: problem.add_inequality}
        return add[role](name, condition, *where)

    def add_integral(
        self, problem: ZeroProblem, name: str, integrand: Field, *, role: Role = Role.MONITOR, mean: bool = False
    ) -> ZeroProblem:
        """Add the integral of g(t, x, p) over the duration, or its mean over time, by Gauss quadrature."""
        z, d, x, T, p = self._symbols()
        values, _ = self.mesh.at_gauss
        points, weights = self.mesh.gauss
        terms = [
            w * integrand(T * (d[1] + c * d[0]), x @ row[:, None], p)
            for c, w, row in zip(points, weights, values, strict=True)
        ]
        total = d[0] * sum(terms, ca.SX(0)) * (1.0 if mean else T)
        return problem.add_function(
            StagedFunction(
                name=name,
                block=BlockFunction(z, total, d),
                inputs=self._inputs(problem),
                outputs=np.zeros((self.mesh.n_intervals, 1), dtype=int),
                data=self._places(),
                role=role,
            )
        )

    def add_periodicity(self, problem: ZeroProblem, *, autonomous: bool) -> ZeroProblem:
        """Close the orbit; an autonomous one also gets a phase: the integral of x_ref' (x - x_ref) vanishes.

        The reference is the last orbit of the path (Doedel, Keller, Kernevez 1991).
        """
        problem = self.add_ends(problem, f"{self.name}.periodicity", lambda first, last, T, p: last - first)
        return problem.add_function(self._phase(problem)) if autonomous else problem

    def _phase(self, problem: ZeroProblem) -> StagedFunction:
        n = self.n_x * (self.mesh.degree + 1)
        z, d = ca.SX.sym("z", n), ca.SX.sym("d", n)
        x, reference = ca.reshape(z, self.n_x, -1), ca.reshape(d, self.n_x, -1)
        values, slopes = self.mesh.at_gauss
        change, slope = (x - reference) @ values.T, reference @ slopes.T
        total = ca.sum1(ca.sum2(slope * change * ca.repmat(ca.DM(self.mesh.gauss[1]).T, self.n_x, 1)))
        inputs = self._inputs(problem)[:, :n]
        return StagedFunction(
            name=f"{self.name}.phase",
            block=BlockFunction(z, total, d),
            inputs=inputs,
            outputs=np.zeros((self.mesh.n_intervals, 1), dtype=int),
            data=problem.start[inputs],
            refresh=lambda unknowns: unknowns,
        )

    def on_mesh_of(self, problem: ZeroProblem) -> "Segment":
        """The segment with the mesh that a problem has it on."""
        widths = problem.stage(f"{self.name}.collocation").data[:, 0]
        knots = np.concatenate([[0.0], np.cumsum(widths)[:-1], [1.0]])
        return replace(self, mesh=Mesh(knots=knots, degree=self.mesh.degree))

    def first(self, problem: ZeroProblem) -> np.ndarray:
        """Indices of the first state, shape (n_x,)."""
        return problem.indices(f"{self.name}.x")[: self.n_x]

    def last(self, problem: ZeroProblem) -> np.ndarray:
        """Indices of the last state, shape (n_x,)."""
        return problem.indices(f"{self.name}.x")[-self.n_x :]

    def states(self, problem: ZeroProblem, u: np.ndarray) -> np.ndarray:
        """States at the base points within unknowns u, shape (n_u,); result (n_points, n_x)."""
        return u[problem.indices(f"{self.name}.x")].reshape(-1, self.n_x)

    def duration(self, problem: ZeroProblem, u: np.ndarray) -> float:
        """Duration within unknowns u, shape (n_u,)."""
        return float(u[problem.indices(f"{self.name}.T")[0]])

    def parameters(self, problem: ZeroProblem, u: np.ndarray) -> np.ndarray:
        """Parameters within unknowns u, shape (n_u,); result (n_p,)."""
        return u[problem.indices(f"{self.name}.p")]

    def _inputs(self, problem: ZeroProblem) -> np.ndarray:
        """Indices of (states of the interval, T, p), shape (N, n_x (degree + 1) + 1 + n_p)."""
        states = problem.indices(f"{self.name}.x").reshape(-1, self.n_x)[self.mesh.members]
        rest = np.concatenate([problem.indices(f"{self.name}.T"), problem.indices(f"{self.name}.p")])
        n = self.mesh.n_intervals
        return np.hstack([states.reshape(n, -1), np.tile(rest, (n, 1))])

    def _places(self) -> np.ndarray:
        """Length and begin of each interval, shape (N, 2)."""
        return np.column_stack([self.mesh.widths, self.mesh.knots[:-1]])

    def _symbols(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        """The vectors z = (x_0 .. x_m, T, p) and d = (length, begin), and x as (n_x, degree + 1), T, p."""
        x = ca.SX.sym("x", self.n_x, self.mesh.degree + 1)
        T, p, d = ca.SX.sym("T"), ca.SX.sym("p", self.n_p), ca.SX.sym("d", 2)
        return ca.vertcat(ca.vec(x), T, p), d, x, T, p

    def _collocation(self) -> BlockFunction:
        z, d, x, T, p = self._symbols()
        values, slopes = self.mesh.at_gauss
        points, weights = self.mesh.gauss
        rows: list[ca.SX] = []
        for c, w, value, slope in zip(points, weights, values, slopes, strict=True):
            f = ca.SX(self.field(T * (d[1] + c * d[0]), x @ value[:, None], p))
            if f.numel() != self.n_x:
                raise ProblemError(
                    f"the field of segment '{self.name}' must return {self.n_x} numbers, got {f.numel()}"
                )
            rows.append(w * (x @ slope[:, None] - d[0] * T * ca.vec(f)))
        return BlockFunction(z, ca.vertcat(*rows), d)
