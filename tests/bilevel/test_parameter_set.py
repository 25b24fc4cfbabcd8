import numpy as np
import pytest
from inverse_toys import unidentifiable, weighted_mean

from gaitlab.bilevel.parameter_set import ParameterSet, Rows, solve_quadratic
from gaitlab.bilevel.parameter_uncertainty import parameter_uncertainty

FAR = np.full(3, 10.0)


def test_a_step_keeps_bounds_simplex_and_limit():
    allowed = ParameterSet(weighted_mean())
    y, target = np.array([0.5, 0.4, 0.1]), np.array([0.2, 0.0, 0.8])
    d = allowed.step(y, np.eye(3), y - target, None, FAR)
    np.testing.assert_allclose(y + d, target, atol=1e-9)
    limited = allowed.step(y, np.eye(3), y - target, None, np.full(3, 0.1))
    assert np.max(np.abs(limited)) <= 0.1 + 1e-12
    assert limited.sum() == pytest.approx(0.0, abs=1e-9)


def test_rows_that_cannot_be_met_have_no_step():
    allowed = ParameterSet(weighted_mean())
    rows = Rows(matrix=np.array([[1.0, 1.0, 1.0]]), lower=np.array([0.5]), upper=np.array([np.inf]))
    assert allowed.step(np.full(3, 1 / 3), np.eye(3), np.zeros(3), rows, FAR) is None


def test_quadratic_programs_against_their_optimality_conditions():
    random = np.random.default_rng(1)
    for _ in range(20):
        root, gradient = random.normal(size=(5, 5)), random.normal(size=5)
        hessian = root @ root.T + 0.1 * np.eye(5)
        bounds = np.full(5, -0.3), np.full(5, 0.3)  # five moves with sum zero cannot all be at a bound
        d = solve_quadratic(
            hessian, gradient, Rows(matrix=np.ones((1, 5)), lower=np.zeros(1), upper=np.zeros(1)), bounds
        )
        slope = gradient + hessian @ d
        inside = np.abs(d) < 0.3 - 1e-7
        # The slope is the same in all free directions, and points outwards at the bounds.
        level = slope[inside].mean()
        np.testing.assert_allclose(slope[inside], level, atol=1e-7)
        assert np.all((slope - level)[~inside] * np.sign(d[~inside]) <= 1e-7)


def test_the_tangent_keeps_active_bounds_and_the_simplex():
    tangent = ParameterSet(weighted_mean()).tangent(np.array([0.0, 0.6, 0.4]))
    assert tangent.shape == (3, 1)
    np.testing.assert_allclose(np.abs(tangent[:, 0]), np.array([0.0, 1.0, 1.0]) / np.sqrt(2.0), atol=1e-12)


def test_a_parameter_at_its_bound_that_changes_nothing_is_not_identifiable():
    p = np.array([0.1, 2.0])
    found = parameter_uncertainty(unidentifiable(), p, np.array([[0.0, 4.0]]), np.zeros((0, 2)))
    assert found.identifiable.tolist() == [False, True]
    assert np.isinf(found.covariance[0, 0])
    assert found.covariance[1, 1] == pytest.approx(1 / 16)


def test_an_active_upper_level_constraint_takes_a_direction_away():
    p = np.array([1.0, 2.0])
    found = parameter_uncertainty(unidentifiable(), p, np.eye(2), np.array([[1.0, -1.0]]))
    np.testing.assert_allclose(found.covariance, np.full((2, 2), 0.5), atol=1e-12)
