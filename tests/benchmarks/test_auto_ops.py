"""AUTO's demo `ops`: the published extremum, and the later ones confirmed on a finer mesh."""

import pytest

from gaitlab.benchmarks.auto_ops import FIRST_EXTREMUM, auto_ops, family, hopf_point
from gaitlab.continuation.collocation_mesh import Mesh
from gaitlab.continuation.extremum import SuccessiveContinuation
from gaitlab.continuation.path_events import Fold
from gaitlab.continuation.path_following import PathFollowing

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
