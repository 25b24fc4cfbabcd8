"""AUTO's demo `opt`: published maxima at the folds."""

import numpy as np
import pytest

from gaitlab.benchmarks.auto_opt import MAXIMA, auto_opt, sphere
from gaitlab.continuation.extended_system import ExtendedSystem
from gaitlab.continuation.extremum import Kind, SuccessiveContinuation
from gaitlab.continuation.path_events import Fold
from gaitlab.continuation.path_following import PathFollowing


def test_maxima_over_one_to_four_parameters():
    found = SuccessiveContinuation().solve(auto_opt())
    assert found.converged
    assert found.kind is Kind.MAXIMUM
    np.testing.assert_allclose([s.objective for s in found.stages[1:]], MAXIMA, atol=1e-9)
    np.testing.assert_allclose(found.x[:5], np.full(5, np.sqrt(0.2)), atol=1e-9)


@pytest.mark.parametrize("maximum", [0, 1])
def test_extrema_are_folds_of_the_objective(maximum):
    """As AUTO finds them: the first along the sphere, the next along the path of partial maxima."""
    found = SuccessiveContinuation().solve(auto_opt())
    if maximum == 0:
        fixed = {"p2": 0.0, "p3": 0.0, "p4": 0.0}
        system, x0 = ExtendedSystem(problem=sphere(), fixed=fixed), sphere().start
    else:
        system, x0 = found.stages[2].point.system, found.stages[1].point.x
    rising = system.parameter_gradient(x0, "p1" if maximum == 0 else "p2")
    path = PathFollowing().follow(system, x0, direction=rising, events=[Fold(parameter="sum", stops=True)])
    assert path.parameters["sum"][-1] == pytest.approx(MAXIMA[maximum], abs=1e-9)
