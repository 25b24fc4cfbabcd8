"""The methods for inverse problems by name: what `gaitlab benchmark ocp` compares."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from ..bilevel.gauss_newton import GaussNewton
from ..bilevel.inverse_problem import InverseProblem
from ..bilevel.inverse_result import InverseResult
from ..errors import NotFound


class InverseMethod(Protocol):
    """Settings of a method."""

    def solve(self, problem: InverseProblem, w0: np.ndarray, p0: np.ndarray) -> InverseResult:
        """Estimate from w0, shape (n_w,), and p0, shape (n_p,). Not converging is a result."""
        ...


METHODS: Mapping[str, InverseMethod] = {
    "gauss-newton": GaussNewton(),
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
