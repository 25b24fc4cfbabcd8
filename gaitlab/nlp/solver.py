"""What every solver of nonlinear programs offers."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from .problem import NLP, Bounds
from .solution import NLPSolution


@dataclass(frozen=True, kw_only=True)
class Multipliers:
    """Start of the dual variables, signs as in `NLPSolution`."""

    lam_w: np.ndarray
    """Of the bounds, shape (n_w,)."""
    lam_g: np.ndarray
    """Of the constraints, shape (n_g,)."""


class PreparedSolver(Protocol):
    """A solver bound to one parametric problem: derivatives are formed once, many solves follow."""

    def solve(
        self, w0: np.ndarray, p: np.ndarray, multipliers: Multipliers | None = None, bounds: Bounds | None = None
    ) -> NLPSolution:
        """Solve for the parameters p, shape (n_p,), from w0, shape (n_w,). Not converging is a result.

        `bounds` replace those of the problem for this solve.
        """
        ...


class NLPSolver(Protocol):
    """Settings of a solver."""

    def prepare(self, nlp: NLP) -> PreparedSolver:
        """Bind the solver to a problem."""
        ...
