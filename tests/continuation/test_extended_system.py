"""The optimality system: derivatives against finite differences, parameters, and the count of equations."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.continuation.extended_system import ExtendedSystem
from gaitlab.continuation.zero_problem import ZeroProblem
from gaitlab.errors import NotFound, ProblemError

STEP = 1e-6


def problem(inequality=False):
    p = ZeroProblem().add_variables("x", [0.3, 0.4, 0.5])
    p = p.add_zero("surface", lambda x: ca.sin(x[0]) * x[1] + x[2] ** 3 - 0.2, "x")
    p = p.add_monitor("f", lambda x: x[0] * x[1] * x[2] + x[0] ** 2, "x").add_parameters(("b", "c"), np.array([1, 2]))
    return p.add_inequality("g", lambda x: x[0] ** 2 + x[1] - 2, "x") if inequality else p


SYSTEMS = {
    "primal": ExtendedSystem(problem=problem(), fixed={"b": 0.4}),
    "trivial": ExtendedSystem(problem=problem(), fixed={"b": 0.4, "d.c": 0.0}, adjoint=True),
    "objective": ExtendedSystem(problem=problem(), fixed={"d.f": 1.0, "d.c": 0.0}, adjoint=True),
    "inequality": ExtendedSystem(
        problem=problem(True), fixed={"d.f": 1.0, "d.c": 0.0, "kappa": 0.1}, adjoint=True, objective="f"
    ),
    "tightening": ExtendedSystem(
        problem=problem(True), fixed={"d.f": 1.0, "d.c": 0.0, "d.b": 0.0}, adjoint=True, objective="f"
    ),
}


@pytest.mark.parametrize("kind", SYSTEMS)
def test_jacobian(kind):
    system = SYSTEMS[kind]
    x = np.random.default_rng(2).normal(size=system.n_x)
    columns = [(system.residual(x + e) - system.residual(x - e)) / (2 * STEP) for e in STEP * np.eye(len(x))]
    jacobian = system.jacobian(x).toarray()
    assert jacobian.shape == (system.n_x - 1, system.n_x)
    np.testing.assert_allclose(jacobian, np.array(columns).T, atol=1e-7)


@pytest.mark.parametrize("name", SYSTEMS["inequality"].parameter_names())
def test_gradients_of_parameters(name):
    system = SYSTEMS["inequality"]
    x = np.random.default_rng(3).normal(size=system.n_x)
    expected = [
        (system.parameter(x + e, name) - system.parameter(x - e, name)) / (2 * STEP) for e in STEP * np.eye(len(x))
    ]
    np.testing.assert_allclose(system.parameter_gradient(x, name), expected, atol=1e-8)


def test_every_solution_of_the_problem_lies_on_the_trivial_branch():
    system = SYSTEMS["trivial"]
    u = np.array([0.3, 0.4, np.cbrt(0.2 - 0.4 * np.sin(0.3))])
    x = np.concatenate([u, np.zeros(system.n_x - 3)])
    assert np.abs(system.residual(x)).max() < 1e-15


def test_complementarity_by_hand():
    system = SYSTEMS["inequality"]
    x = system.first_point(np.array([0.0, 2.0, 0.0, 0.0, 3.0]), kappa=0.1)
    g = 0.3**2 + 0.4 - 2
    np.testing.assert_allclose(system.residual(x)[1 + 3], -3.0 * g - 0.1 * 2.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fixed": {}}, r"fix 1 more of \['f', 'b', 'c'\]"),
        ({"fixed": {"b": 0.0, "c": 0.0}}, r"release 1 of \['b', 'c'\]"),
        ({"fixed": {"d.f": 1.0}, "adjoint": True}, "fix 1 more"),
        ({"problem": problem(True), "fixed": {}, "adjoint": True}, "objective among the monitors"),
    ],
)
def test_wrong_counts_are_explained(options, message):
    with pytest.raises(ProblemError, match=message):
        ExtendedSystem(**({"problem": problem()} | options))


def test_unknown_parameter():
    with pytest.raises(NotFound, match="continuation parameter 'q'"):
        ExtendedSystem(problem=problem(), fixed={"q": 1.0})


def test_primal_system_knows_no_multipliers():
    with pytest.raises(NotFound, match=r"d\.f"):
        SYSTEMS["primal"].parameter(np.zeros(3), "d.f")
