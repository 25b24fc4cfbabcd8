"""Bad problems end with a status and a sentence that names what is to blame."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from chain_problems import regulator, shortest_time

from gaitlab.errors import ProblemError
from gaitlab.nlp.ipopt import Ipopt
from gaitlab.nlp.outcome import Outcome
from gaitlab.ocp.constraint import Bounds, Constraint, PointConstraint
from gaitlab.ocp.problem import MultiStageProblem
from gaitlab.ocp.stage import fixed
from gaitlab.ocp.trajectory import straight_line
from gaitlab.transcription.multiple_shooting import MultipleShooting
from gaitlab.transcription.optimal_control import Solve

METHOD = MultipleShooting(grids=5)
SOLVE = Solve(solver=Ipopt(max_iter=200))


def changed(problem, **changes):
    return replace(problem, stages=(replace(problem.stages[0], **changes),))


def solve(problem, q=(), p=(1.0,)):
    return SOLVE(METHOD.transcribe(problem), straight_line(problem, np.array(q)), np.array(p))


def test_a_good_problem_is_solved_and_certified():
    result = solve(regulator(), p=(1.0, 1.0))
    assert result.converged and result.minimum and result.reason == "solved"


def test_an_infeasible_problem_names_the_constraint():
    problem = shortest_time()
    problem = replace(problem, q_bounds=Bounds(lower=np.array([0.1]), upper=np.array([1.0])))
    result = solve(problem, q=(1.0,))
    assert not result.converged and not result.minimum
    assert result.solution.outcome is Outcome.INFEASIBLE
    assert "of stage 'move'" in result.reason and "misses its bounds" in result.reason


def test_an_unbounded_problem_names_the_variable():
    problem = regulator()
    problem = changed(problem, lagrange={"state": -(problem.stages[0].u ** 2), "control": -problem.stages[0].x})
    result = solve(problem, p=(1.0, 1.0))
    assert not result.converged
    assert "of stage 'regulate'" in result.reason


def test_a_number_that_is_not_finite_names_the_equation():
    problem = regulator()
    result = solve(changed(problem, ode=ca.log(problem.stages[0].x - 5.0)), p=(1.0, 1.0))
    assert not result.converged
    assert "differential equation of x in interval" in result.reason


def test_contradicting_constraints_are_named():
    problem = regulator()
    point = problem.point(1.0)
    rules = [
        Constraint(name=name, expression=point.x, lower=np.full(1, value), upper=np.full(1, value))
        for name, value in (("low", 1.0), ("high", 2.0))
    ]
    problem = problem.with_points(*[PointConstraint(points=(point,), constraint=rule) for rule in rules])
    result = solve(problem, p=(1.0, 1.0))
    assert not result.converged
    assert "point constraint 'low'" in result.reason or "point constraint 'high'" in result.reason


def test_a_repeated_constraint_is_solved_or_named():
    problem = changed(regulator(), end=fixed(0.5))
    end = problem.point(1.0)
    again = Constraint(name="again", expression=2 * end.x, lower=np.ones(1), upper=np.ones(1))
    result = solve(problem.with_points(PointConstraint(points=(end,), constraint=again)), p=(1.0, 1.0))
    assert result.converged or "lost rank" in result.reason


def test_a_saddle_is_not_called_a_minimum():
    u = ca.SX.sym("u")
    problem = changed(regulator(), u=u, ode=u, lagrange={"state": -(u**2), "control": u**4}, start=fixed(0.0))
    transcribed = METHOD.transcribe(problem)
    result = SOLVE(transcribed, np.zeros(transcribed.nlp.w.numel()), np.array([1.0, 1.0]))
    assert not (result.minimum and abs(result.solution.f) < 1e-9)


@pytest.mark.parametrize(
    ("p", "sentence"), [([1.0], "must be 2 numbers"), ([1.0, np.nan], "control is nan: give a finite number")]
)
def test_parameters_that_cannot_be_are_refused(p, sentence):
    with pytest.raises(ProblemError, match=sentence):
        solve(regulator(), p=p)


def test_a_problem_without_stages_is_refused():
    with pytest.raises(ProblemError, match="at least one stage"):
        MultiStageProblem(stages=())
