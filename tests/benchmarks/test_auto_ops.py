"""AUTO's demo `ops`: the published extremum, and the later ones confirmed on a finer mesh."""

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gaitlab.benchmarks.auto_ops import FIRST_EXTREMUM, auto_ops, family, field, hopf_point
from gaitlab.continuation.collocation_mesh import Mesh
from gaitlab.continuation.extremum import SuccessiveContinuation
from gaitlab.continuation.path_events import Fold
from gaitlab.continuation.path_following import PathFollowing

X, P = ca.SX.sym("x", 3), ca.SX.sym("p", 4)
METHOD = SuccessiveContinuation(path=PathFollowing(step=0.05))


def test_hopf_point_by_hand():
    """Eigenvalues on the imaginary axis: the cubic's coefficients obey a1 a2 = a0 there (Routh)."""
    x, p1, p2, p4 = (hopf_point()[i] for i in (0, 3, 4, 6))
    e, c = 1 / p2, (-p4 * (x**2 - 1) - 1 / p2) / p1
    # det(s - f_x) = s^3 + a2 s^2 + a1 s + a0
    a2, a1, a0 = e - c, -c * e - e**2 / p1 + 1 / p1, e / p1
    assert a2 * a1 == pytest.approx(a0, abs=1e-10)


def test_first_extremum_is_a_fold_of_the_family():
    path = family(Mesh.uniform(15), (Fold(parameter="p3", stops=True),))
    assert path.parameters["p3"][-1] == pytest.approx(FIRST_EXTREMUM, abs=1e-6)


def test_orbit_at_the_fold_closes_when_integrated():
    """Truth: an explicit integrator of high order that knows nothing of collocation."""
    path = family(Mesh.uniform(30), (Fold(parameter="p3", stops=True),))
    u = path.x[-1]
    start, duration, p = u[:3], u[-5], u[-4:]
    rhs = ca.Function("f", [X, P], [field(ca.SX(0), X, P)])
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12}
    orbit = solve_ivp(lambda t, x: np.asarray(rhs(x, p)).ravel(), (0, duration), start, **options)
    np.testing.assert_allclose(orbit.y[:, -1], start, atol=1e-6)


def test_first_extremum_as_a_branch_point():
    found = METHOD.solve(auto_ops(15, ()))
    assert found.converged, found.reason
    assert found.objective == pytest.approx(FIRST_EXTREMUM, abs=1e-6)
    assert found.residual < 1e-9


@pytest.mark.slow
def test_extrema_over_two_and_three_parameters_do_not_depend_on_the_mesh():
    coarse, fine = (METHOD.solve(auto_ops(n)) for n in (20, 30))
    assert coarse.converged, coarse.reason
    assert fine.converged, fine.reason
    for a, b in zip(coarse.stages, fine.stages, strict=True):
        assert a.objective == pytest.approx(b.objective, abs=1e-6)
