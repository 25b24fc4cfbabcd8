"""Goal attainment on minimax problems whose solutions are known."""

import casadi as ca
import numpy as np
import pytest
from symbolic_minimax import SymbolicMinimax, charalambous_bandler, on_the_circle, rosen_suzuki

from gaitlab.errors import ProblemError
from gaitlab.nlp.goal_attainment import GoalAttainment
from gaitlab.nlp.minimax import MinimaxStatus

KNOWN = {  # problem: start, optimum (Charalambous and Conn, SIAM J. Numer. Anal. 15, 1978; the last one by hand)
    charalambous_bandler: ([1.0, -0.1], 1.9522245),
    rosen_suzuki: ([0.0, 0.0, 0.0, 0.0], -44.0),
    on_the_circle: ([1.2, -0.3], np.sqrt(0.4)),
}


@pytest.mark.parametrize("build", KNOWN)
def test_known_optimum(build):
    start, optimum = KNOWN[build]
    problem = SymbolicMinimax(len(start), build)
    solution = GoalAttainment().solve(problem, np.array(start))
    assert solution.status is MinimaxStatus.SOLVED
    assert solution.value == pytest.approx(optimum, abs=1e-6)
    assert solution.is_optimal(1e-5)
    assert solution.is_minimum


def test_the_optimum_may_lie_on_a_bound():
    problem = SymbolicMinimax(2, charalambous_bandler, lower=[1.5, -5.0], upper=[5.0, 5.0])
    solution = GoalAttainment().solve(problem, np.array([3.0, 3.0]))
    assert solution.status is MinimaxStatus.SOLVED
    assert solution.w[0] == 1.5
    assert solution.multipliers.lam_w[0] < 0.0


def test_a_stationary_point_need_not_be_a_minimum():
    """On the circle x^2 + y^2 = 2 the largest of x alone is least at the left; the right end is stationary, too."""
    problem = SymbolicMinimax(2, lambda w: ([w[0]], [ca.sumsqr(w) - 2.0]))
    worst, best = (GoalAttainment().solve(problem, np.array([x, 0.0])) for x in (np.sqrt(2.0), -np.sqrt(2.0)))
    assert worst.status is best.status is MinimaxStatus.SOLVED
    assert best.is_minimum
    assert not worst.is_minimum


def test_multipliers_sum_to_one():
    start, _ = KNOWN[charalambous_bandler]
    solution = GoalAttainment().solve(SymbolicMinimax(2, charalambous_bandler), np.array(start))
    assert solution.multipliers.mu.sum() == pytest.approx(1.0)
    assert solution.multipliers.mu.min() >= 0.0


def test_contradicting_constraints_are_named():
    problem = SymbolicMinimax(2, lambda w: ([w[0]], [w[0] - 1.0, w[0] + w[1] ** 2 + 1.0]))
    solution = GoalAttainment().solve(problem, np.array([0.3, 0.4]))
    assert solution.status is MinimaxStatus.INFEASIBLE
    assert "constraint" in solution.reason


def test_unbounded():
    solution = GoalAttainment().solve(SymbolicMinimax(1, lambda w: ([w[0], w[0] - 1.0], [])), np.zeros(1))
    assert solution.status is MinimaxStatus.UNBOUNDED


def test_not_a_number_at_the_start():
    solution = GoalAttainment().solve(SymbolicMinimax(1, lambda w: ([ca.log(w[0] - 1.0)], [])), np.zeros(1))
    assert solution.status is MinimaxStatus.INVALID_NUMBER


def test_not_a_number_on_the_way_is_avoided():
    problem = SymbolicMinimax(1, lambda w: ([w[0] - 0.1 * ca.log(w[0])], []))
    solution = GoalAttainment(radius=100.0).solve(problem, np.array([3.0]))
    assert solution.status is MinimaxStatus.SOLVED
    assert solution.w[0] == pytest.approx(0.1, abs=1e-5)


def test_wrong_start():
    problem = SymbolicMinimax(2, charalambous_bandler)
    with pytest.raises(ProblemError, match="shape"):
        GoalAttainment().solve(problem, np.zeros(3))
    with pytest.raises(ProblemError, match="finite"):
        GoalAttainment().solve(problem, np.array([np.nan, 0.0]))
