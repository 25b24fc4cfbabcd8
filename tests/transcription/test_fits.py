"""One-level parameter estimation: the same classes without criteria."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.ocp.constraint import Bounds
from gaitlab.ocp.measurement import Measurement
from gaitlab.ocp.problem import MultiStageProblem
from gaitlab.ocp.stage import Stage
from gaitlab.ocp.trajectory import straight_line
from gaitlab.transcription.collocation import DirectCollocation
from gaitlab.transcription.integrators import RungeKutta4
from gaitlab.transcription.multiple_shooting import MultipleShooting
from gaitlab.transcription.optimal_control import Solve

RATE, START = 1.3, 2.0
TIMES = np.array([0.0, 0.05, 0.31, 0.5, 0.77, 1.0])


def decay():
    """dx/dt = -rate x over 2 s."""
    x, rate = ca.SX.sym("x"), ca.SX.sym("rate")
    return MultiStageProblem(stages=(Stage(name="decay", x=x, ode=-rate * x, duration=2.0),), p=rate)


def measured(problem, values):
    x = problem.stages[0].x
    function = ca.vertcat(x, x**2)
    return Measurement(name="x", function=function, times=TIMES, values=values, sd=np.full(values.shape, 0.1))


def exact():
    x = START * np.exp(-RATE * 2.0 * TIMES)
    return np.column_stack([x, x**2])


@pytest.mark.parametrize(
    "method", [MultipleShooting(grids=10, integrator=RungeKutta4(n_steps=4)), DirectCollocation(grids=10)]
)
def test_exact_measurements_between_nodes_give_the_parameter_and_the_start(method):
    problem = decay()
    values = exact()
    values[2, 1] = np.nan
    fit = measured(problem, values)
    free = problem.with_free_parameters(Bounds(lower=np.zeros(1), upper=np.full(1, 9.0)))
    transcribed = method.transcribe(free, fit=(fit,))
    result = Solve()(transcribed, straight_line(free, np.array([0.5])), np.zeros(0))
    assert result.converged and result.minimum
    assert result.solution.f == pytest.approx(0.0, abs=1e-8)
    np.testing.assert_allclose([result.trajectory.q[0], result.trajectory.stages[0].x[0, 0]], [RATE, START], rtol=1e-5)


def test_residuals_are_what_the_fit_squares():
    problem = decay()
    fit = measured(problem, exact() + 0.2)
    method = MultipleShooting(grids=4)
    transcribed = method.transcribe(problem, fit=(fit,))
    residual = transcribed.residual((fit,))
    w, p = np.linspace(1.0, 2.0, transcribed.nlp.w.numel()), np.array([0.7])
    f, r = ca.Function("both", [transcribed.nlp.w, transcribed.nlp.p], [transcribed.nlp.f, residual])(w, p)
    assert r.numel() == 12
    assert float(f) == pytest.approx(0.5 * float(ca.sumsqr(r)), rel=1e-12)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"times": np.array([0.0, 2.0])}, "fractions of the stage"),
        ({"sd": np.zeros((2, 1))}, "standard deviations"),
        ({"values": np.zeros((3, 1))}, r"values of measurement 'x' must have shape \(2, 1\)"),
    ],
)
def test_impossible_measurements_are_refused(change, sentence):
    good = {"times": np.array([0.0, 1.0]), "values": np.zeros((2, 1)), "sd": np.ones((2, 1))}
    with pytest.raises(ProblemError, match=sentence):
        Measurement(name="x", function=ca.SX.sym("x"), **(good | change))


def test_measurements_of_another_problem_are_refused():
    problem = decay()
    fit = measured(problem, exact())
    foreign = replace(fit, function=ca.vertcat(ca.SX.sym("force"), fit.function[1]))
    with pytest.raises(ProblemError, match="measurement 'x' uses force; symbols that it may use: t, x, rate"):
        MultipleShooting(grids=2).transcribe(problem, fit=(foreign,))
    with pytest.raises(ProblemError, match="measurement 'x' is of stage 4; there are 1"):
        MultipleShooting(grids=2).transcribe(problem).residual((replace(fit, stage=4),))
