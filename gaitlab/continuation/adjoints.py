"""Multipliers of a given point, and what they say: which kind of extremum it is."""

import numpy as np
from scipy import sparse
from scipy.linalg import eigh

from .bordered import factorised, solve, stacked
from .extended_system import ADJOINT, ExtendedSystem
from .staged_function import Entries, Role
from .zero_problem import ZeroProblem


def estimated_multipliers(system: ExtendedSystem, u: np.ndarray, kappa: float = 0.0) -> np.ndarray | None:
    """Multipliers, shape (n_rows,), that solve the adjoint equations at u, shape (n_u,), best in least squares.

    Those that the system fixes keep their values, those of inequalities obey the complementarity relaxed by kappa.
    None where they are not unique.
    """
    problem = system.problem
    A = matrix(problem.jacobian(u), (problem.n_rows, problem.n_u)).T
    conditions = _conditions(system, u, kappa)
    C = matrix(conditions[0], (len(conditions[1]), problem.n_rows))
    # min |A l|^2 subject to C l = c: unknowns are the residual, l and the multipliers of the conditions.
    saddle = stacked([[sparse.identity(problem.n_u), A, None], [A.T, None, C.T], [None, C, None]])
    rhs = np.concatenate([np.zeros(problem.n_u + problem.n_rows), conditions[1]])
    solution = solve(saddle, rhs)
    return None if solution is None else solution[problem.n_u : problem.n_u + problem.n_rows]


def _conditions(system: ExtendedSystem, u: np.ndarray, kappa: float) -> tuple[Entries, np.ndarray]:
    """Rows C, shape (n, n_rows), and right-hand sides, shape (n,), of what is known of the multipliers."""
    problem = system.problem
    entries: list[tuple[int, int, float]] = []
    values: list[float] = []
    for name, value in system.fixed.items():
        if name.startswith(ADJOINT):
            entries.append((len(values), problem.rows[name.removeprefix(ADJOINT)].start, 1.0))
            values.append(value)
    for name in problem.names_of(Role.INEQUALITY):
        entries.append((len(values), problem.rows[name].start, -float(problem.stage(name).values(u)[0])))
        entries.append((len(values), problem.rows[str(system.objective)].start, -kappa))
        values.append(0.0)
    rows, cols, numbers = zip(*entries, strict=True)
    return Entries(np.array(rows), np.array(cols), np.array(numbers)), np.array(values)


def reduced_curvature(
    system: ExtendedSystem, x: np.ndarray, objective: str, held: tuple[str, ...]
) -> np.ndarray | None:
    """Eigenvalues, ascending, shape (n_free,), of the objective's second derivative along the solutions at x, (n_x,).

    The Hessian of the Lagrangian on the null space of the equations, of the monitors in `held` and of the active
    inequalities, in the inner product of the unknowns; all positive at a strict minimum (Nocedal and Wright 2006,
    Theorem 12.6). None where the constraints are dependent or the objective's multiplier vanishes.
    """
    problem, u, multipliers = system.problem, system.unknowns(x), system.multipliers(x)
    scale = multipliers[problem.rows[objective].start]
    active = [n for n in problem.names_of(Role.INEQUALITY) if abs(multipliers[problem.rows[n].start]) > 1e-6]
    rows = [*range(problem.n_zero), *(problem.rows[name].start for name in (*held, *active))]
    J = matrix(problem.jacobian(u), (problem.n_rows, problem.n_u))[rows]
    n_free = problem.n_u - J.shape[0]
    if n_free <= 0 or scale == 0.0:
        return np.zeros(0) if scale else None
    # Random rows complete the constraints to a regular matrix; its inverse holds a basis of their null space.
    border = np.random.default_rng(0).normal(size=(n_free, problem.n_u))
    factors = factorised(stacked([[J], [sparse.csr_matrix(border)]]))
    if factors is None:
        return None
    Z = factors.solve(np.vstack([np.zeros((J.shape[0], n_free)), np.eye(n_free)]))
    H = matrix(problem.adjoint_jacobian(u, multipliers / scale), (problem.n_u, problem.n_u))
    return np.asarray(eigh(Z.T @ (H @ Z), Z.T @ (problem.weights[:, None] * Z), eigvals_only=True))


def matrix(entries: Entries, shape: tuple[int, int]) -> sparse.csr_matrix:
    """Sparse matrix of the given shape from its entries."""
    return sparse.csr_matrix((entries.values, (entries.rows, entries.cols)), shape=shape)


def held_monitors(problem: ZeroProblem, free: tuple[str, ...]) -> tuple[str, ...]:
    """Monitors that are not among the free ones."""
    return tuple(name for name in problem.names_of(Role.MONITOR) if name not in free)
