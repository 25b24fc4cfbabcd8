"""Piecewise polynomials: exact where they should be, of the right order elsewhere."""

import numpy as np
import pytest

from gaitlab.continuation.collocation_mesh import Mesh
from gaitlab.errors import ProblemError

KNOTS = np.array([0.0, 0.1, 0.4, 0.5, 1.0])


def front(t):
    """A steep front at 0.3."""
    return np.tanh(40.0 * (t - 0.3))[:, None]


def interpolation_error(mesh):
    t = np.linspace(0.0, 1.0, 2001)
    return np.abs(mesh.evaluate(front(mesh.points), t) - front(t)).max()


@pytest.mark.parametrize("degree", [1, 3, 5])
def test_polynomials_of_the_degree_are_exact(degree):
    mesh, t = Mesh(knots=KNOTS, degree=degree), np.linspace(0.0, 1.0, 31)
    polynomial = np.polynomial.Polynomial(np.arange(1.0, degree + 2.0))
    x = polynomial(mesh.points)[:, None]
    np.testing.assert_allclose(mesh.evaluate(x, t)[:, 0], polynomial(t), rtol=1e-12)
    values, slopes = mesh.at_gauss
    gauss = KNOTS[1] + mesh.widths[1] * mesh.gauss[0]
    np.testing.assert_allclose(values @ x[mesh.members[1], 0], polynomial(gauss), rtol=1e-12)
    np.testing.assert_allclose(slopes @ x[mesh.members[1], 0] / mesh.widths[1], polynomial.deriv()(gauss), rtol=1e-10)


def test_next_derivative_of_a_power():
    mesh = Mesh.uniform(8, degree=3)
    np.testing.assert_allclose(mesh.next_derivative(mesh.points[:, None] ** 4), 24.0, rtol=1e-9)


def test_error_estimate_is_about_the_error():
    mesh = Mesh.uniform(40)
    assert 0.2 <= mesh.error(front(mesh.points)) * 2.0 / interpolation_error(mesh) <= 5.0


def test_error_estimate_falls_with_its_order():
    errors = [Mesh.uniform(n).error(np.sin(6.0 * Mesh.uniform(n).points)[:, None]) for n in (20, 40)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.1)


def test_adaption_reduces_the_error():
    mesh = Mesh.uniform(20)
    for _ in range(3):
        better = mesh.adapted(front(mesh.points))
        assert better.n_intervals == 20
        mesh = better
    assert interpolation_error(mesh) < 0.05 * interpolation_error(Mesh.uniform(20))


def test_transfer_to_a_finer_mesh_changes_nothing():
    coarse, fine = Mesh(knots=KNOTS), Mesh(knots=np.sort(np.append(KNOTS, [0.2, 0.7])))
    x, t = np.random.default_rng(0).normal(size=(coarse.n_points, 2)), np.linspace(0.0, 1.0, 23)
    np.testing.assert_allclose(fine.evaluate(coarse.transfer(x, fine), t), coarse.evaluate(x, t), atol=1e-11)


@pytest.mark.parametrize("knots", [[0.0], [0.0, 0.5], [0.1, 1.0], [0.0, 0.6, 0.4, 1.0], [[0.0, 1.0]]])
def test_bad_knots(knots):
    with pytest.raises(ProblemError, match="increase from 0 to 1"):
        Mesh(knots=np.array(knots))
