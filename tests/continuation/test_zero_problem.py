"""Building problems stage by stage, and gluing whole ones."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.continuation.staged_function import Role
from gaitlab.continuation.zero_problem import ZeroProblem
from gaitlab.errors import NotFound, ProblemError


def circle():
    problem = ZeroProblem().add_variables("x", [0.6, 0.8])
    problem = problem.add_zero("circle", lambda x: ca.sumsqr(x) - 1, "x")
    return problem.add_monitor("product", lambda x: x[0] * x[1], "x").add_parameters(("first", "second"), "x")


def glued():
    problem = ZeroProblem().embed("a", circle()).embed("b", circle())
    return problem.add_zero("glue", lambda a, b: a[0] - b[1], "a.x", "b.x")


def test_rows_are_equations_then_monitors_then_inequalities():
    problem = circle().add_inequality("g", lambda x: x[0] - 1, "x").add_zero("late", lambda x: x[0] - x[1], "x")
    assert problem.names_of(Role.ZERO) == ("circle", "late")
    assert [problem.rows[n].start for n in ("circle", "late", "product", "first", "second", "g")] == [0, 1, 2, 3, 4, 5]
    np.testing.assert_allclose(problem.values(np.array([0.6, 0.8])), [0, -0.2, 0.48, 0.6, 0.8, -0.4], atol=1e-15)


def test_gluing_keeps_the_parts():
    problem, u = glued(), np.array([0.3, 0.4, 0.5, 0.6])
    np.testing.assert_allclose(problem.values(u)[problem.rows["b.circle"]], [0.25 + 0.36 - 1])
    np.testing.assert_allclose(problem.values(u)[problem.rows["glue"]], [0.3 - 0.6])
    assert problem.stage("b.second").values(u) == 0.6


def test_adjoint_of_a_glued_problem_is_that_of_all_stages():
    """The block structure of the seed: one adjoint system per part, bordered by the conditions between them."""
    problem, u = glued(), np.array([0.3, 0.4, 0.5, 0.6])
    J = np.zeros((problem.n_rows, problem.n_u))
    entries = problem.jacobian(u)
    np.add.at(J, (entries.rows, entries.cols), entries.values)
    multipliers = np.random.default_rng(0).normal(size=problem.n_rows)
    np.testing.assert_allclose(problem.adjoint(u, multipliers), J.T @ multipliers, atol=1e-14)
    np.testing.assert_array_equal(J[problem.rows["a.circle"], 2:], 0.0)
    np.testing.assert_array_equal(J[problem.rows["b.circle"], :2], 0.0)


def test_adding_leaves_the_smaller_problem_alone():
    small = circle()
    small.add_variables("y", 1.0)
    assert small.n_u == 2


def test_unknown_variable():
    with pytest.raises(NotFound, match="variable 'z' does not exist; available: x"):
        circle().add_zero("f", lambda z: z, "z")


@pytest.mark.parametrize(
    ("add", "message"),
    [
        (lambda p: p.add_variables("x", [1.0]), "new name"),
        (lambda p: p.add_variables("y", [np.nan]), "finite"),
        (lambda p: p.add_zero("circle", lambda x: x, "x"), "already"),
        (lambda p: p.add_monitor("m", lambda x: x, "x"), "one number, got 2"),
        (lambda p: p.add_zero("f", lambda x: x, np.array([5])), "within 0 and 1"),
        (
            lambda p: p.add_zero("f", lambda x: x[3], "x"),
            r"stage 'f' is no CasADi expression of vectors of sizes \[2\]",
        ),
        (lambda p: p.add_zero("f", lambda x: "text", "x"), "stage 'f' is no CasADi expression"),
        (lambda p: p.add_parameters(("only",), "x"), "2 parameters"),
        (lambda p: p.embed("a", circle()).embed("a", circle()), "already"),
        (lambda p: p.starting_at(np.zeros(3)), "shape"),
    ],
)
def test_malformed_problems_are_explained(add, message):
    with pytest.raises(ProblemError, match=message):
        add(circle())


def test_culprit_of_a_number_that_is_not_finite():
    problem = circle().add_monitor("logarithm", lambda x: ca.log(x[0]), "x")
    assert problem.not_finite(np.array([-1.0, 0.0])) == "logarithm"
    assert problem.not_finite(problem.start) is None
