"""The smooth form of minimax problems."""

import numpy as np
import pytest
from finite_differences import jacobian_by_differences
from symbolic_minimax import SymbolicMinimax, charalambous_bandler

from gaitlab.errors import ProblemError
from gaitlab.nlp.minimax import MinimaxStatus
from gaitlab.nlp.p_norm import PNorm, _Smooth, p_norm

START = np.array([1.0, -0.1])


def test_tends_to_the_largest_value_with_the_exponent():
    problem = SymbolicMinimax(2, charalambous_bandler)
    excess = [PNorm(exponents=(a,)).solve(problem, START).value - 1.9522245 for a in (10.0, 100.0, 1000.0)]
    assert excess[0] > 5 * excess[1] > 25 * excess[2] > 0.0


def test_solved_and_certified():
    solution = PNorm().solve(SymbolicMinimax(2, charalambous_bandler), START)
    assert solution.status is MinimaxStatus.SOLVED
    assert solution.is_optimal(1e-4)
    assert solution.objective < solution.value


def test_derivatives():
    smooth, w = _Smooth(problem=SymbolicMinimax(2, charalambous_bandler), exponent=20.0), np.array([1.1, 0.7])
    point, nothing = smooth.evaluate(w), np.zeros(0)
    gradient = jacobian_by_differences(lambda w: smooth.evaluate(w).values, w)
    hessian = jacobian_by_differences(lambda w: smooth.evaluate(w).gradients, w)
    np.testing.assert_allclose(point.gradients, gradient, rtol=1e-6)
    np.testing.assert_allclose(point.hessian(np.ones(1), nothing), hessian, rtol=1e-6)


def test_p_norm():
    values, weights = np.array([3.0, 4.0, -9.0, 100.0]), np.array([1.0, 1.0, 1.0, 0.0])
    assert p_norm(values, weights, 2.0) == pytest.approx(5.0)
    assert p_norm(-values[:2], weights[:2], 2.0) == -3.0


def test_exponents_below_one_are_refused():
    with pytest.raises(ProblemError, match="at least 1"):
        PNorm(exponents=(0.5,))
