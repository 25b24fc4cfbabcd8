from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from chain_problems import doubling_jump, everything, regulator

from gaitlab.errors import NotFound, ProblemError
from gaitlab.ocp.constraint import Bounds, Constraint, Point, PointConstraint
from gaitlab.ocp.problem import MultiStageProblem
from gaitlab.ocp.stage import Stage, fixed
from gaitlab.ocp.transition import Transition, continuous

X = ca.SX.sym("x", 2)


def stage(**changes):
    return Stage(**({"name": "one", "x": X, "ode": -X, "duration": 1.0} | changes))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"ode": -X[0]}, r"the ode of stage 'one' must have shape \(2, 1\), got \(1, 1\)"),
        ({"x": X * 2}, "x of stage 'one' must be a column of symbols"),
        ({"x": ca.SX(0, 1), "ode": ca.SX(0, 1)}, "stage 'one' has no state"),
        ({"mayer": {"end": X}}, "the Mayer term 'end' of stage 'one'"),
        ({"lagrange": {"run": X}}, "the Lagrange term 'run' of stage 'one'"),
        ({"start": fixed(0.0)}, "start of stage 'one' must have size 2, got 1"),
        ({"u_bounds": Bounds.symmetric(1.0)}, "u_bounds of stage 'one' must have size 0, got 1"),
    ],
)
def test_shapes_are_checked(changes, sentence):
    with pytest.raises(ProblemError, match=sentence):
        stage(**changes)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"ode": X * ca.SX.sym("mass")}, "the ode of stage 'one' uses mass; symbols that it may use: t, x_0, x_1"),
        ({"duration": X[0]}, "the duration of stage 'one' uses x_0"),
        ({"mayer": {"end": ca.SX.sym("load")}}, "the Mayer term 'end' of stage 'one' uses load"),
        ({"lagrange": {"run": ca.SX.sym("load")}}, "the Lagrange term 'run' of stage 'one' uses load"),
    ],
)
def test_symbols_that_nobody_declared_are_named(changes, sentence):
    with pytest.raises(ProblemError, match=sentence):
        MultiStageProblem(stages=(stage(**changes),))


def test_bounds_that_cross_are_refused():
    with pytest.raises(ProblemError, match="bound 1 of a vector is empty: from 1 to 0"):
        Bounds(lower=np.array([0.0, 1.0]), upper=np.array([0.0, 0.0]))
    with pytest.raises(ProblemError, match="bound 0 of constraint 'c' is empty"):
        Constraint(name="c", expression=X[0], lower=np.array([np.nan]), upper=np.array([1.0]))


def test_transitions_are_checked():
    with pytest.raises(ProblemError, match="2 stages need 1 transitions, got 0"):
        replace(doubling_jump(), transitions=())
    with pytest.raises(ProblemError, match="the transition from stage 'before' to 'after' must have shape"):
        replace(doubling_jump(), transitions=(continuous(X),))
    with pytest.raises(ProblemError, match="the transition from stage 'before' to 'after' uses x_0"):
        replace(doubling_jump(), transitions=(Transition(next_state=X[0]),))


def test_points_are_checked():
    problem = regulator()
    rule = Constraint(name="far", expression=ca.SX.sym("y"), lower=np.zeros(1), upper=np.zeros(1))
    with pytest.raises(ProblemError, match="point constraint 'far' uses y"):
        problem.with_points(PointConstraint(points=(problem.point(0.5),), constraint=rule))
    with pytest.raises(ProblemError, match="stage 3 does not exist; there are 1"):
        problem.point(0.5, stage=3)
    with pytest.raises(ProblemError, match="a point's time must be a fraction"):
        Point(stage=0, time=1.5, x=X)


def test_parameters_are_given_by_name():
    problem = everything()
    values = {"end": 1.0, "effort": 2.0, "size": 3.0, "p_0": 4.0, "p_1": 5.0}
    assert problem.parameter_names == tuple(values)
    np.testing.assert_array_equal(problem.parameters(values), [1.0, 2.0, 3.0, 4.0, 5.0])
    with pytest.raises(ProblemError, match="no value is given for p_1"):
        problem.parameters({name: 1.0 for name in values if name != "p_1"})
    with pytest.raises(NotFound, match="criterion or parameter 'p_2' does not exist; available: effort, end"):
        problem.parameters(values | {"p_2": 0.0})


def test_criteria_and_parameters_need_different_names():
    p = ca.SX.sym("end")
    with pytest.raises(ProblemError, match="criteria and parameters need different names"):
        MultiStageProblem(stages=(stage(mayer={"end": X[0]}),), p=p)


def test_free_parameters_become_control_values():
    free = everything().with_free_parameters(Bounds.symmetric(2.0, 3.0))
    assert free.p.numel() == 0
    assert [free.q[i].name() for i in range(4)] == ["q_0", "q_1", "p_0", "p_1"]
    np.testing.assert_array_equal(free.control_value_bounds.upper, [np.inf, np.inf, 2.0, 3.0])
