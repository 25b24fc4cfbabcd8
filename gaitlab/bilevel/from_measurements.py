"""Inverse problems of optimal control problems with measurements."""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..ocp.constraint import PointConstraint
from ..ocp.measurement import Measurement
from ..transcription.transcribed import Transcribed
from .inverse_problem import InverseProblem


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimated:
    """Weights and parameters to be estimated, by name.

    Raises:
        ProblemError: The bounds do not fit the names.
    """

    names: tuple[str, ...]
    lower: np.ndarray
    """Lower bounds, shape (n,)."""
    upper: np.ndarray
    """Upper bounds, shape (n,)."""
    weights_sum_to_one: bool = False
    """Whether the weights among the names form a simplex."""

    def __post_init__(self) -> None:
        n = len(self.names)
        if self.lower.shape != (n,) or self.upper.shape != (n,):
            raise ProblemError(
                f"{n} parameters need bounds of shape ({n},), got {self.lower.shape} and {self.upper.shape}"
            )


def inverse_problem(
    transcribed: Transcribed,
    measurements: Sequence[Measurement],
    estimated: Estimated,
    nominal: np.ndarray,
    upper: Sequence[PointConstraint] = (),
) -> InverseProblem:
    """Bilevel least squares with the transcribed problem as lower level.

    `nominal` holds the values of all (theta, p), shape (n_p,); `upper` are upper-level constraints.

    Raises:
        NotFound: A name is neither a criterion nor a parameter.
        ProblemError: Shapes or bounds do not fit.
    """
    problem = transcribed.problem
    chosen = [problem.parameter_index(name) for name in estimated.names]
    n_p = len(problem.parameter_names)
    free, lower, upper_bounds = np.zeros(n_p, dtype=bool), np.full(n_p, -np.inf), np.full(n_p, np.inf)
    free[chosen], lower[chosen], upper_bounds[chosen] = True, estimated.lower, estimated.upper
    weights = tuple(i for i in chosen if i < len(problem.criteria))
    rules = [each.constraint for each in upper]
    return InverseProblem(
        nlp=transcribed.nlp,
        residual=transcribed.residual(measurements),
        free=free,
        lbp=lower,
        ubp=upper_bounds,
        p_nominal=np.asarray(nominal, dtype=float),
        simplex=weights if estimated.weights_sum_to_one else (),
        upper=ca.vertcat(ca.SX(0, 1), *[transcribed.expression(each) for each in upper]),
        lbu=np.concatenate([np.zeros(0), *[rule.lower for rule in rules]]),
        ubu=np.concatenate([np.zeros(0), *[rule.upper for rule in rules]]),
        names=problem.parameter_names,
    )
