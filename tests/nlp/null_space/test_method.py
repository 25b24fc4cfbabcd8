"""Algorithm 4 on small problems, good and bad."""

import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.nlp.null_space.method import BlackBoxStatus, NullSpaceProjection
from gaitlab.nlp.null_space.problem import BlackBoxProblem


def squares(x):
    return float(x @ x)


def solve(x0, max_iter=200, **functions):
    return NullSpaceProjection(max_iter=max_iter).solve(BlackBoxProblem(**functions), np.array(x0, float))


def test_multipliers_are_those_of_the_optimum():
    """min x^2 + y^2 with x + y = 2 and x >= 1.5: lam = -2 y = -1, mu = 2 x + lam."""
    solution = solve(
        [0, 0], cost=squares, equality=lambda x: np.array([x.sum() - 2.0]), inequality=lambda x: np.array([1.5 - x[0]])
    )
    assert solution.solved
    np.testing.assert_allclose(solution.x, [1.5, 0.5], atol=1e-3)
    np.testing.assert_allclose(solution.equality_multipliers, [-1.0], atol=1e-2)
    np.testing.assert_allclose(solution.inequality_multipliers, [2.0], atol=1e-2)


def test_a_start_far_from_feasible():
    """The nearest point of a circle to the origin's neighbour, from outside and from inside."""
    for start in ([7.0, -9.0], [0.1, -0.2]):
        solution = solve(start, cost=lambda x: x[0] + 2.0 * x[1], equality=lambda x: np.array([x @ x - 5.0]))
        assert solution.solved
        np.testing.assert_allclose(solution.x, [-1.0, -2.0], atol=2e-3)


def test_repeated_constraints():
    solution = solve([4, 4, 4], cost=squares, equality=lambda x: np.array([x[0] - 1.0, 3.0 * x[0] - 3.0, 0.0]))
    assert solution.solved
    np.testing.assert_allclose(solution.x, [1.0, 0.0, 0.0], atol=1e-3)


def test_contradicting_constraints_are_named():
    solution = solve(
        [0.5],
        cost=squares,
        equality=lambda x: np.array([x[0] - 1.0, x[0] + 1.0]),
        equality_names=("right foot", "left foot"),
    )
    assert solution.status is BlackBoxStatus.INFEASIBLE
    assert "left foot" in solution.reason


def test_no_feasible_inequality():
    solution = solve([0.5, 1.0], cost=squares, inequality=lambda x: np.array([1.0 + x[0] ** 2]))
    assert solution.status is BlackBoxStatus.INFEASIBLE
    assert "inequality constraint 0" in solution.reason


def test_unbounded():
    assert solve([0.0, 0.0], cost=lambda x: x[0] - x[1]).status is BlackBoxStatus.UNBOUNDED


@pytest.mark.parametrize(
    ("functions", "name"),
    [
        ({"cost": lambda x: np.nan}, "cost"),
        ({"cost": squares, "equality": lambda x: np.array([0.0, np.nan])}, "equality constraint 1"),
        ({"cost": squares, "inequality": lambda x: np.array([np.inf])}, "inequality constraint 0"),
        ({"cost": lambda x: 1 / 0}, "cost"),
    ],
)
def test_not_a_number_at_the_start(functions, name):
    solution = solve([1.0, 2.0], **functions)
    assert solution.status is BlackBoxStatus.INVALID_NUMBER
    assert name in solution.reason
    assert "x0" in solution.reason


def test_not_a_number_on_the_way_is_a_wall():
    solution = solve([3.0], cost=lambda x: float(x[0] - 0.1 * np.log(x[0])) if x[0] > 0 else np.nan)
    assert solution.solved
    assert solution.x[0] == pytest.approx(0.1, abs=1e-3)


def test_a_kink_is_no_solution():
    solution = solve([1.0, 2.0], cost=lambda x: float(abs(x[0]) + abs(x[1] - 0.3 * x[0])))
    assert solution.status in (BlackBoxStatus.STALLED, BlackBoxStatus.ITERATION_LIMIT)


def test_iteration_limit():
    solution = solve([-1.0, 1.0], max_iter=3, cost=lambda x: float(100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2))
    assert solution.status is BlackBoxStatus.ITERATION_LIMIT
    assert solution.iterations == 3


def test_interim_is_called_once_per_iteration():
    calls = []
    solution = solve([3.0, 1.0], cost=squares, interim=calls.append)
    assert len(calls) == solution.iterations


@pytest.mark.parametrize(
    ("x0", "functions", "message"),
    [
        ([np.nan], {}, "finite"),
        ([1.0], {"equality": lambda x: np.zeros((2, 2))}, "shape"),
        ([1.0], {"equality": lambda x: np.zeros(int(10 * x[0]) % 7)}, "shape"),
        ([1.0], {"inequality": lambda x: np.zeros(2), "inequality_names": ("one",)}, "2 entries"),
    ],
)
def test_malformed_problems(x0, functions, message):
    with pytest.raises(ProblemError, match=message):
        solve(x0, cost=lambda x: (x[0] - 3.0) ** 2, **functions)
