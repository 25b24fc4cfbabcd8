from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest
from symbolic_program import SymbolicProgram

from gaitlab.nlp.sparse_solution import Status, certify


@dataclass
class Point:
    w: np.ndarray
    lam_g: np.ndarray
    lam_c: np.ndarray
    s: np.ndarray


@pytest.fixture
def program():
    """Minimise x0^2 + x1 subject to x0 + x1 = 1 and x1 >= 0: solution (0.5, 0.5), lam_g = -1, lam_c = 0."""
    x = ca.SX.sym("x", 2)
    return SymbolicProgram(x, x[0] ** 2 + x[1], g=[x[0] + x[1] - 1], c=[x[1]])


def residuals(program, w, lam_g, lam_c, s=0.5):
    point = Point(*(np.array(v, dtype=float) for v in (w, [lam_g], [lam_c], [s])))
    solution = certify(program, point, mu=0.0, iterations=3, status=Status.SOLVED)
    r = solution.residuals
    return solution, (r.stationarity, r.primal, r.complementarity)


def test_the_solution_is_certified(program):
    solution, found = residuals(program, [0.5, 0.5], -1.0, 0.0)
    np.testing.assert_allclose(found, 0.0, atol=1e-15)
    assert solution.is_optimal(1e-12)
    assert solution.f == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("w", "lam_g", "lam_c", "expected"),
    [
        ([0.5, 0.5], -1.0, 0.2, (0.2, 0.0, 0.1)),
        ([0.5, 0.5], -0.7, 0.0, (0.3, 0.0, 0.0)),
        ([1.5, -0.5], -3.0, 0.0, (2.0, 0.5, 0.0)),
        ([0.5, 0.8], -1.0, 0.0, (0.0, 0.3, 0.0)),
    ],
)
def test_residuals_by_hand(program, w, lam_g, lam_c, expected):
    """With the true constraint values: the solver's slack, here wrong, does not count."""
    solution, found = residuals(program, w, lam_g, lam_c, s=77.0)
    np.testing.assert_allclose(found, expected, atol=1e-14)
    assert not solution.is_optimal(1e-6)
