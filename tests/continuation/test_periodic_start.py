"""Where orbits begin."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.continuation.collocation_mesh import Mesh
from gaitlab.continuation.periodic_start import field_jacobian, hopf_test, small_orbit
from gaitlab.errors import ProblemError


def field(t, x, p):
    """Hopf bifurcation at p = 0 with angular frequency 3."""
    return ca.vertcat(p * x[0] - 3 * x[1], 3 * x[0] + p * x[1], -x[2] + x[0] ** 2)


def jacobian(p):
    return field_jacobian(field, np.zeros(3), np.array([p]))


def test_jacobian_of_the_field():
    np.testing.assert_allclose(jacobian(0.5), [[0.5, -3, 0], [3, 0.5, 0], [0, 0, -1]])


def test_hopf_test_changes_sign():
    assert hopf_test(jacobian(-0.1)) * hopf_test(jacobian(0.1)) < 0.0
    assert hopf_test(jacobian(0.0)) == pytest.approx(0.0, abs=1e-12)


def test_small_orbit_solves_the_linear_system():
    mesh = Mesh.uniform(10)
    orbit = small_orbit(jacobian(0.0), np.zeros(3), 0.1, mesh)
    assert orbit.duration == pytest.approx(2 * np.pi / 3)
    slope = np.gradient(mesh.evaluate(orbit.x, np.linspace(0, 1, 2001)), 1 / 2000, axis=0) / orbit.duration
    np.testing.assert_allclose(
        slope[1:-1], mesh.evaluate(orbit.x, np.linspace(0, 1, 2001))[1:-1] @ jacobian(0.0).T, atol=1e-3
    )


@pytest.mark.parametrize(("p", "message"), [(0.5, "no Hopf point")])
def test_wrong_equilibria(p, message):
    with pytest.raises(ProblemError, match=message):
        small_orbit(jacobian(p), np.zeros(3), 0.1, Mesh.uniform(4))
    with pytest.raises(ProblemError, match="does not oscillate"):
        small_orbit(np.diag([1.0, 2.0]), np.zeros(2), 0.1, Mesh.uniform(4))
