import casadi as ca
import numpy as np
import pytest

from gaitlab.benchmarks.ocp_collection import benchmark
from gaitlab.bilevel.from_measurements import Estimated, inverse_problem
from gaitlab.bilevel.gauss_newton import GaussNewton
from gaitlab.errors import NotFound, ProblemError
from gaitlab.ocp.constraint import Constraint, PointConstraint
from gaitlab.transcription.optimal_control import Solve


@pytest.fixture(scope="module")
def car():
    chosen = benchmark("reeds-shepp-controls")
    transcribed = chosen.transcribe()
    return chosen, transcribed, Solve()(transcribed, chosen.start, chosen.truth).solution.w


def posed(car, estimated, upper=()):
    chosen, transcribed, w = car
    return inverse_problem(transcribed, chosen.simulate(transcribed, w), estimated, chosen.truth, upper)


def all_weights(**changes):
    return Estimated(names=("time", "speed", "turning"), lower=np.zeros(3), upper=np.ones(3), **changes)


def test_names_become_places_and_weights_a_simplex(car):
    problem = posed(car, all_weights(weights_sum_to_one=True))
    assert problem.simplex == (0, 1, 2) and problem.free.all()
    assert problem.names == ("time", "speed", "turning")
    partly = posed(car, Estimated(names=("speed",), lower=np.zeros(1), upper=np.full(1, 5.0)))
    np.testing.assert_array_equal(partly.free, [False, True, False])
    assert partly.ubp[1] == 5.0 and partly.simplex == ()


def test_weights_on_the_simplex_are_found(car):
    problem = posed(car, all_weights(weights_sum_to_one=True))
    result = GaussNewton().solve(problem, car[2], np.array([0.5, 0.3, 0.2]))
    assert result.is_certified(1e-6)
    assert result.p.sum() == pytest.approx(1.0, abs=1e-9)
    np.testing.assert_allclose(result.p, 1 / 3, atol=0.02)


def test_an_upper_level_constraint_on_a_state_holds(car):
    chosen, _, w = car
    middle = chosen.problem.point(0.475)
    estimated = Estimated(names=("time", "speed"), lower=np.zeros(2), upper=np.full(2, 20.0))

    def with_limit(limit):
        rule = Constraint(name="far enough", expression=middle.x[0], lower=np.array([limit]), upper=np.array([np.inf]))
        return posed(car, estimated, upper=(PointConstraint(points=(middle,), constraint=rule),))

    free = with_limit(-np.inf)
    value = ca.Function("value", [free.nlp.w, free.nlp.p], [free.upper])
    without = GaussNewton().solve(free, w, chosen.truth)
    limit = float(value(without.w, without.p)) + 0.002
    within = GaussNewton().solve(with_limit(limit), w, chosen.truth)
    assert within.converged and within.objective > without.objective
    assert float(value(within.w, within.p)) == pytest.approx(limit, abs=1e-7)


def test_unknown_names_and_wrong_bounds_are_refused(car):
    with pytest.raises(NotFound, match="'comfort' does not exist; available: speed, time, turning"):
        posed(car, Estimated(names=("comfort",), lower=np.zeros(1), upper=np.ones(1)))
    with pytest.raises(ProblemError, match="2 parameters need bounds of shape"):
        Estimated(names=("time", "speed"), lower=np.zeros(1), upper=np.ones(2))
