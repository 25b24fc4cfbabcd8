"""The methods for inverse problems by name: what `gaitlab benchmark ocp` compares."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from ..bilevel.bundle import Bundle
from ..bilevel.derivative_free import DerivativeFree
from ..bilevel.gauss_newton import GaussNewton
from ..bilevel.inverse_problem import InverseProblem
from ..bilevel.inverse_result import InverseResult
from ..bilevel.kkt_reformulation import KKTReformulation
from ..bilevel.plateau import OffThePlateau
from ..errors import NotFound
from ..nlp.complementarity.lifting import LiftingL1, LiftingL2
from ..nlp.complementarity.penalty import Penalty
from ..nlp.complementarity.relaxation import Relaxation
from ..nlp.complementarity.unlifted import Unlifted
from ..nlp.ipopt import Ipopt
from ..nlp.uno import Uno


class InverseMethod(Protocol):
    """Settings of a method."""

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from w0, shape (n_w,), and p0, shape (n_p,). Not converging is a result."""
        ...


TREATMENTS = {
    "unlifted": Unlifted,
    "lifting-l1": LiftingL1,
    "lifting-l2": LiftingL2,
    "penalty": Penalty,
    "relaxation": Relaxation,
}
"""Of the complementarity of the all-at-once approach."""

SOLVERS = {"ipopt": Ipopt(seconds=60.0), "filtersqp": Uno(seconds=120.0)}
"""Of its subproblems, with their limits of time [s]."""

METHODS: Mapping[str, InverseMethod] = {
    "gauss-newton": GaussNewton(),
    "derivative-free": OffThePlateau(method=DerivativeFree()),
    "bundle": OffThePlateau(method=Bundle()),
    **{
        f"{name}-{solver}": OffThePlateau(method=KKTReformulation(method=treatment(solver=SOLVERS[solver])))
        for solver in SOLVERS
        for name, treatment in TREATMENTS.items()
    },
}
"""The first is the fast path."""


def inverse_method(name: str) -> InverseMethod:
    """Look a method up.

    Raises:
        NotFound: There is none of this name.
    """
    if name not in METHODS:
        raise NotFound("method", name, METHODS)
    return METHODS[name]
