"""Extremal problems that cannot be solved end with a status and a sentence."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from gaitlab.benchmarks.one_mass_oscillator import PUBLISHED_PEAK, one_mass_oscillator, reaction_force
from gaitlab.errors import ProblemError
from gaitlab.nlp.goal_attainment import GoalAttainment
from gaitlab.nlp.minimax import MinimaxStatus
from gaitlab.nlp.p_norm import PNorm
from gaitlab.transcription.adjoint_simulation import AdjointSimulation

START = np.zeros(20)


def solve(w0=START, method=GoalAttainment(), **changes):  # noqa: B008 - settings are frozen
    return method.solve(AdjointSimulation(problem=replace(one_mass_oscillator(), **changes)), w0)


@pytest.mark.parametrize(
    "method", [GoalAttainment(max_iter=40), PNorm(exponents=(50.0,), solver=GoalAttainment(max_iter=40))]
)
def test_forces_too_weak_for_the_final_state(method):
    solution = solve(method=method, lower=np.array([-1.0]), upper=np.array([1.0]))
    assert solution.status is MinimaxStatus.INFEASIBLE
    assert "constraint" in solution.reason


def test_repeated_final_constraints():
    problem = one_mass_oscillator()
    x = problem.x
    solution = solve(**vars(problem) | {"terminal": ca.vertcat(x[0] - 1.0, x[1], 2.0 * x[1])})
    assert solution.status is MinimaxStatus.SOLVED
    assert reaction_force(solution.value) == pytest.approx(PUBLISHED_PEAK, abs=5e-4)


def test_dynamics_without_a_value_at_the_start():
    problem = one_mass_oscillator()
    dynamics = ca.vertcat(problem.x[1], ca.log(problem.u - 1.0))
    solution = solve(**vars(problem) | {"dynamics": dynamics})
    assert solution.status is MinimaxStatus.INVALID_NUMBER
    assert "start" in solution.reason


def test_iteration_limit():
    solution = solve(method=GoalAttainment(max_iter=2))
    assert solution.status is MinimaxStatus.ITERATION_LIMIT
    assert solution.iterations == 2


def test_a_start_of_the_wrong_size():
    with pytest.raises(ProblemError, match="shape"):
        solve(w0=np.zeros(7))
