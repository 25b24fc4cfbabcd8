"""How a solver of nonlinear programs ended, in words that do not depend on the solver."""

from enum import StrEnum


class Outcome(StrEnum):
    """End of a solve. `SOLVED` is the solver's claim; certificates are computed apart."""

    SOLVED = "solved"
    INFEASIBLE = "no feasible point found"
    UNBOUNDED = "the objective falls without bound"
    STALLED = "stalled: no step improves feasibility or the objective"
    ITERATION_LIMIT = "iteration limit reached"
    TIME_LIMIT = "time limit reached"
    INVALID_NUMBER = "a function returned a number that is not finite"
    CRASHED = "the solver's process ended"
