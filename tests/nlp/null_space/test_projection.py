import numpy as np
import pytest

from gaitlab.nlp.null_space.projection import allowed_descent, null_space_projection


def test_projection_against_the_formula():
    generator = np.random.default_rng(0)
    J, d = generator.normal(size=(3, 7)), generator.normal(size=7)
    formula = (np.eye(7) - J.T @ np.linalg.inv(J @ J.T) @ J) @ d
    np.testing.assert_allclose(null_space_projection(J, d), formula, atol=1e-12)


def test_repeated_and_vanishing_rows_do_no_harm():
    J, d = np.array([[1.0, 0, 0], [2.0, 0, 0], [0, 0, 0]]), np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(null_space_projection(J, d), [0, 2, 3], atol=1e-12)


def test_inequalities_hold_only_against_their_side():
    gradient, none = np.array([1.0, -1.0]), np.zeros((0, 2))
    upper = np.eye(2)  # x <= 0 in both coordinates
    direction, _, mu = allowed_descent(gradient, none, upper)
    np.testing.assert_allclose(direction, [-1, 0])
    np.testing.assert_allclose(mu, [0, 1])


@pytest.mark.parametrize("seed", range(5))
def test_moreau(seed):
    """What is cut off is orthogonal to the direction, and the direction violates nothing."""
    generator = np.random.default_rng(seed)
    gradient, J_eq, J_in = generator.normal(size=8), generator.normal(size=(2, 8)), generator.normal(size=(9, 8))
    direction, lam, mu = allowed_descent(gradient, J_eq, J_in)
    np.testing.assert_allclose(J_eq @ direction, 0, atol=1e-9)
    assert np.max(J_in @ direction) < 1e-9
    assert direction @ (lam @ J_eq + mu @ J_in) == pytest.approx(0, abs=1e-9)
