"""Least-squares measurements of functions of states and controls."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..errors import ProblemError
from .problem import MultiStageProblem
from .symbols import require_known


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    r"""Measured values of :math:`h(t, x, u; q, p)` at points of one stage.

    Contributes :math:`\frac12 \sum_{ij} (h_j(t_i) - \eta_{ij})^2 / \sigma_{ij}^2` (Hatz 2014, (4.4)). Times are
    fractions of the stage's duration: with a free duration the number of measurements inside the stage would jump
    otherwise (sec. 14.1).

    Raises:
        ProblemError: Shapes do not fit, a time is outside the stage, a standard deviation is not positive.
    """

    name: str
    function: ca.SX
    """h of the stage's (t, x, u), of q and of p, shape (n_h, 1)."""
    times: np.ndarray
    """Fractions of the duration, from 0 to 1, shape (n_t,)."""
    values: np.ndarray
    """Measured values eta, shape (n_t, n_h); a value that is not a number is left out."""
    sd: np.ndarray
    """Standard deviations sigma, shape (n_t, n_h)."""
    stage: int = 0

    def __post_init__(self) -> None:
        shape = (self.times.size, self.function.numel())
        if self.function.shape[1] != 1 or self.times.ndim != 1:
            raise ProblemError(f"measurement '{self.name}' needs a column of functions and a vector of times")
        for what, values in (("values", self.values), ("sd", self.sd)):
            if values.shape != shape:
                raise ProblemError(f"{what} of measurement '{self.name}' must have shape {shape}, got {values.shape}")
        if not np.all((self.times >= 0.0) & (self.times <= 1.0)):
            raise ProblemError(f"times of measurement '{self.name}' must be fractions of the stage, from 0 to 1")
        if not np.all(self.sd > 0.0):
            raise ProblemError(f"standard deviations of measurement '{self.name}' must be positive")


def check_measurement(problem: MultiStageProblem, measurement: Measurement) -> None:
    """Raise `errors.ProblemError` where a measurement does not belong to the problem."""
    if not 0 <= measurement.stage < len(problem.stages):
        raise ProblemError(
            f"measurement '{measurement.name}' is of stage {measurement.stage}; there are {len(problem.stages)}"
        )
    stage = problem.stages[measurement.stage]
    known = (stage.t, stage.x, stage.u, problem.q, problem.p)
    require_known(f"measurement '{measurement.name}'", measurement.function, known)
