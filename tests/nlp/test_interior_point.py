"""The interior-point method on problems whose solutions are known."""

import casadi as ca
import numpy as np
import pytest
from symbolic_program import SymbolicProgram

from gaitlab.errors import Cancelled
from gaitlab.nlp.interior_point import InteriorPoint
from gaitlab.nlp.sparse_solution import Status


def box(x, lower, upper):
    return [x[i] - lower for i in range(x.numel())] + [upper - x[i] for i in range(x.numel())]


def hock_schittkowski_6(x):
    return {"f": (1 - x[0]) ** 2, "g": [10 * (x[1] - x[0] ** 2)]}


def hock_schittkowski_7(x):
    return {"f": ca.log(1 + x[0] ** 2) - x[1], "g": [(1 + x[0] ** 2) ** 2 + x[1] ** 2 - 4]}


def hock_schittkowski_35(x):
    a, b, c = x[0], x[1], x[2]
    f = 9 - 8 * a - 6 * b - 4 * c + 2 * a**2 + 2 * b**2 + c**2 + 2 * a * b + 2 * a * c
    return {"f": f, "c": [3 - a - b - 2 * c, a, b, c]}


def hock_schittkowski_39(x):
    return {"f": -x[0], "g": [x[1] - x[0] ** 3 - x[2] ** 2, x[0] ** 2 - x[1] - x[3] ** 2]}


def hock_schittkowski_43(x):
    a, b, c, d = (x[i] for i in range(4))
    f = a**2 + b**2 + 2 * c**2 + d**2 - 5 * a - 5 * b - 21 * c + 7 * d
    limits = [
        8 - a**2 - b**2 - c**2 - d**2 - a + b - c + d,
        10 - a**2 - 2 * b**2 - c**2 - 2 * d**2 + a + d,
        5 - 2 * a**2 - b**2 - c**2 - 2 * a + b + d,
    ]
    return {"f": f, "c": limits}


def hock_schittkowski_71(x):
    f = x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]
    return {"f": f, "g": [ca.sumsqr(x) - 40], "c": [x[0] * x[1] * x[2] * x[3] - 25, *box(x, 1, 5)]}


def saddle_on_a_disc(x):
    return {"f": x[0] * x[1], "c": [2 - ca.sumsqr(x)]}


KNOWN = {  # problem: start, solution (Hock and Schittkowski, Test Examples for Nonlinear Programming Codes, 1981)
    hock_schittkowski_6: ([-1.2, 1.0], [1.0, 1.0]),
    hock_schittkowski_7: ([2.0, 2.0], [0.0, np.sqrt(3.0)]),
    hock_schittkowski_35: ([0.5, 0.5, 0.5], [4 / 3, 7 / 9, 4 / 9]),
    hock_schittkowski_39: ([2.0, 2.0, 2.0, 2.0], [1.0, 1.0, 0.0, 0.0]),
    hock_schittkowski_43: ([0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 2.0, -1.0]),
    hock_schittkowski_71: ([1.0, 5.0, 5.0, 1.0], [1.0, 4.74299963, 3.82114998, 1.37940829]),
    saddle_on_a_disc: ([0.3, -0.1], [1.0, -1.0]),
}


def program(problem, n):
    x = ca.SX.sym("x", n)
    return SymbolicProgram(x, **problem(x))


@pytest.mark.parametrize("problem", KNOWN, ids=lambda problem: problem.__name__)
def test_known_solutions(problem):
    start, expected = KNOWN[problem]
    solution = InteriorPoint().solve(program(problem, len(start)), np.array(start))
    assert solution.status is Status.SOLVED, solution
    assert solution.is_optimal(1e-6)
    np.testing.assert_allclose(solution.w, expected, atol=2e-5)


@pytest.mark.parametrize("seed", range(5))
def test_smallest_eigenvalue_is_the_minimum_over_the_sphere(seed):
    """Indefinite Hessians and no local minimum besides the global one: only a corrected inertia leads there."""
    generator = np.random.default_rng(seed)
    matrix = generator.normal(size=(6, 6))
    matrix += matrix.T
    x = ca.SX.sym("x", 6)
    rayleigh = SymbolicProgram(x, ca.bilin(matrix, x, x), g=[ca.sumsqr(x) - 1])
    solution = InteriorPoint().solve(rayleigh, generator.normal(size=6))
    assert solution.status is Status.SOLVED
    assert solution.f == pytest.approx(np.linalg.eigvalsh(matrix)[0], abs=1e-7)


def test_the_final_barrier_parameter_is_a_setting():
    """Minimise x - mu log x: x = mu, with multiplier one."""
    x = ca.SX.sym("x")
    solution = InteriorPoint(mu_initial=1.0, mu_final=0.05).solve(SymbolicProgram(x, x, c=[x]), np.array([3.0]))
    assert solution.status is Status.SOLVED
    np.testing.assert_allclose([solution.w[0], solution.lam_c[0]], [0.05, 1.0], rtol=1e-6)
    assert solution.mu == 0.05


def test_a_warm_start_needs_fewer_iterations():
    start, expected = KNOWN[hock_schittkowski_71]
    problem = program(hock_schittkowski_71, 4)
    cold = InteriorPoint(mu_final=1e-6).solve(problem, np.array(start))
    warm = InteriorPoint(mu_initial=1e-6, mu_final=1e-6).solve(problem, cold)
    assert warm.status is Status.SOLVED
    assert warm.iterations <= 2 < cold.iterations
    np.testing.assert_allclose(warm.w, expected, atol=1e-4)


HOPELESS = {
    "no real root": lambda x: {"f": x[0], "g": [x[0] ** 2 + 1]},
    "contradicting limits": lambda x: {"f": x[0] ** 2, "c": [x[0] - 1, -x[0] - 1]},
    "contradicting equations": lambda x: {"f": ca.sumsqr(x), "g": [x[0] + x[1], x[0] + x[1] - 1]},
    "unbounded": lambda x: {"f": -x[0]},
    "unbounded below a limit": lambda x: {"f": x[0] - x[1] ** 2, "c": [3 - x[0]]},
    "unbounded exponential": lambda x: {"f": -ca.exp(x[0]) + x[1] ** 2},
}


@pytest.mark.parametrize("name", HOPELESS)
def test_hopeless_problems_end_with_a_status(name):
    solution = InteriorPoint(max_iter=60).solve(program(HOPELESS[name], 2), np.array([0.5, 0.7]))
    assert solution.status in {Status.STALLED, Status.ITERATION_LIMIT, Status.INVALID_NUMBER}
    assert not solution.is_optimal(1e-6)


def test_dependent_equations_do_not_hinder():
    x = ca.SX.sym("x", 2)
    twice = SymbolicProgram(x, ca.sumsqr(x), g=[x[0] + x[1] - 1, 2 * x[0] + 2 * x[1] - 2])
    solution = InteriorPoint().solve(twice, np.array([3.0, 1.0]))
    np.testing.assert_allclose(solution.w, [0.5, 0.5], atol=1e-6)


NOT_FINITE = {
    "objective": lambda x: {"f": ca.sqrt(x[0])},
    "equation": lambda x: {"f": x[0] ** 2, "g": [ca.log(x[0])]},
    "inequality": lambda x: {"f": x[0] ** 2, "c": [ca.log(x[0])]},
    "derivative": lambda x: {"f": ca.sqrt(x[0] + 1)},
}


@pytest.mark.parametrize("name", NOT_FINITE)
def test_functions_that_are_not_finite(name):
    solution = InteriorPoint().solve(program(NOT_FINITE[name], 1), np.array([-1.0]))
    assert solution.status is Status.INVALID_NUMBER
    assert not solution.is_optimal(np.inf)


def test_steps_stay_where_functions_are_finite():
    """The full Newton step of x - log x from 10 leaves the domain."""
    x = ca.SX.sym("x")
    solution = InteriorPoint().solve(SymbolicProgram(x, x - ca.log(x)), np.array([10.0]))
    np.testing.assert_allclose(solution.w, 1.0, atol=1e-7)


def test_tolerances_below_rounding_do_no_harm():
    """The filter compares up to rounding, and regularisations do not grow from iteration to iteration."""
    start, expected = KNOWN[hock_schittkowski_71]
    solution = InteriorPoint(tol=1e-30, max_iter=60).solve(program(hock_schittkowski_71, 4), np.array(start))
    assert solution.status in {Status.STALLED, Status.ITERATION_LIMIT}
    assert solution.is_optimal(1e-7)
    np.testing.assert_allclose(solution.w, expected, atol=1e-6)


def test_progress_may_cancel():
    calls = []

    def progress(iteration, error):
        calls.append((iteration, error))
        if iteration == 2:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        InteriorPoint().solve(program(hock_schittkowski_71, 4), np.array([1.0, 5.0, 5.0, 1.0]), progress)
    assert [iteration for iteration, _ in calls] == [0, 1, 2]


def test_the_iteration_limit_is_a_status():
    solution = InteriorPoint(max_iter=2).solve(program(hock_schittkowski_71, 4), np.array([1.0, 5.0, 5.0, 1.0]))
    assert solution.status is Status.ITERATION_LIMIT
    assert solution.iterations == 2
