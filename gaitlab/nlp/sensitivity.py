r"""How a solution moves with the parameters of its problem.

Differentiating the barrier problem's optimality conditions gives one linear system with the matrix of the last
Newton step (implicit function theorem; Fiacco 1976; Pirnay, Lopez-Negrete, Biegler 2012). Active inequalities need no
bookkeeping: their barrier weights are what holds the solution to them.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np

from ..errors import NotConverged
from .kkt_matrix import KKTFactors, kkt_assembly
from .sparse_problem import Derivatives, SparseProblem, multiply, multiply_transposed
from .sparse_solution import SparseSolution


class Sensitivity:
    """Factorised KKT system of one solution, for any number of right-hand sides."""

    def __init__(self, problem: SparseProblem, solution: SparseSolution) -> None:
        self.solution, self.structure = solution, problem.structure
        self.assembly = kkt_assembly(self.structure)
        self.sigma = solution.lam_c / solution.s
        found = problem.derivatives(solution.w, solution.lam_g, solution.lam_c)
        # What it is made from is large and would be kept as long as this.
        self.derivatives: Derivatives = found._replace(gauss_newton=None)
        self._matrix = self.assembly.matrix(
            (self.derivatives.hess, self.derivatives.jac_g, self.derivatives.jac_c), self.sigma
        )

    def is_minimum(self) -> bool:
        """Second-order sufficiency: the reduced Hessian is positive definite (inertia of the KKT matrix)."""
        return self._factors is not None and self._factors.negative_eigenvalues == self.structure.n_g

    def of_objective(self, mixed: np.ndarray) -> np.ndarray:
        """Derivative of (w, lam_g) when grad f moves by `mixed`, shape (n_w, m); result (n_w + n_g, m).

        Raises `errors.NotConverged` where the KKT matrix is singular.
        """
        n_g, n_c, m = self.structure.n_g, self.structure.n_c, mixed.shape[1]
        return self.of_conditions(mixed, np.zeros((n_g, m)), np.zeros((n_c, m)))

    def of_conditions(self, mixed: np.ndarray, equalities: np.ndarray, inequalities: np.ndarray) -> np.ndarray:
        """Derivative of (w, lam_g) when the gradient of the Lagrangian, g and c move at a fixed point.

        Moves of shapes (n_w, m), (n_g, m) and (n_c, m); result (n_w + n_g, m). Raises `errors.NotConverged` where the
        KKT matrix is singular.
        """
        s, weighted = self.structure, self.sigma[:, None] * inequalities
        pressed = [multiply_transposed(s.jac_c, self.derivatives.jac_c, column, s.n_w) for column in weighted.T]
        top = mixed + np.stack(pressed, axis=1)
        moves = None if self._factors is None else self._factors.solve(-np.concatenate([top, equalities]))
        if moves is None:
            raise NotConverged(
                "the optimality conditions of this solution are singular, so it has no sensitivities; "
                "its constraints depend on each other or it is no strict minimum"
            )
        return moves

    @cached_property
    def _factors(self) -> KKTFactors | None:
        return self.assembly.factorise(self._matrix)

    def slack_moves(self, direction: np.ndarray) -> np.ndarray:
        """J_c dw for a direction of (w, lam_g), shape (n_w + n_g,); result (n_c,)."""
        s = self.structure
        return multiply(s.jac_c, self.derivatives.jac_c, direction[: s.n_w], s.n_c)

    def predict(self, direction: np.ndarray, inequalities: np.ndarray | None = None) -> SparseSolution:
        """First-order prediction of the solution after a move, direction of (w, lam_g), shape (n_w + n_g,).

        `inequalities` is how far c moves at a fixed point, shape (n_c,); nought by default.
        """
        x, n_w = self.solution, self.structure.n_w
        dw = direction[:n_w]
        ds = self.slack_moves(direction) + (0.0 if inequalities is None else inequalities)
        # A linear prediction must not leave the interior.
        s = np.maximum(x.s + ds, 0.1 * x.s)
        lam_c = np.maximum(x.lam_c - self.sigma * ds, 0.1 * x.lam_c)
        return replace(x, w=x.w + dw, s=s, lam_g=x.lam_g + direction[n_w:], lam_c=lam_c)
