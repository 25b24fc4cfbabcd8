"""The cost, in the directions that the constraints leave (Algorithm 3)."""

import numpy as np

from .feasibility import Feasible
from .line_search import StepLengths, doubling_search
from .problem import Evaluations
from .projection import allowed_descent

MARGIN = 2.0
"""Weight of violated constraints beside their multipliers: an exact penalty (Nocedal and Wright 2006, sec. 17.2)."""


def reduce_cost(evaluations: Evaluations, start: Feasible, gradient: np.ndarray, steps: StepLengths) -> np.ndarray:
    """Algorithm 3 from a feasible point with the gradient of the cost there, shape (n,); result (n,).

    As printed, line 24 compares with the cost at the start of the search; that of the last point is meant. Inequalities
    that are not active stop the search, as in the source.
    The active constraints bend away from the straight search: the source leaves the equalities to the next iteration
    and the step without a limit, here their violation is charged with twice their multipliers.
    """
    direction, lam, mu = allowed_descent(gradient, start.equality_rows, start.inequality_rows)
    free = np.ones(evaluations.n_inequality, dtype=bool)
    free[start.active] = False
    weights = MARGIN * float(np.abs(lam).max(initial=0.0)), MARGIN * float(mu.max(initial=0.0))

    def merit(x: np.ndarray) -> float:
        excess = evaluations.inequality(x)
        if np.any(excess[free] > 0.0):
            return float("inf")
        violation = float(np.abs(evaluations.equality(x)).sum())
        return evaluations.cost(x) + weights[0] * violation + weights[1] * float(np.maximum(excess, 0.0)[~free].sum())

    return doubling_search(merit, start.x, direction, steps) if np.any(direction) else start.x
