"""Integrals over autonomous orbits: free and bounded optimum by formula."""

import pytest

from gaitlab.benchmarks.limit_cycle import limit_cycle
from gaitlab.continuation.extremum import Kind, SuccessiveContinuation

METHOD = SuccessiveContinuation()


def test_free_optimum():
    found = METHOD.solve(limit_cycle())
    assert found.converged, found.reason
    assert found.kind is Kind.MAXIMUM
    assert found.parameters == pytest.approx({"mean square": 0.5, "p1": 1.0, "p2": -0.5}, abs=1e-8)


@pytest.mark.parametrize("bound", [0.8, 0.95])
def test_optimum_at_an_inequality(bound):
    found = METHOD.solve(limit_cycle(bound=bound))
    assert found.converged, found.reason
    assert found.parameters == pytest.approx(
        {"mean square": (1.0 - (bound - 1.0) ** 2) / 2.0, "p1": bound, "p2": -0.5}, abs=1e-8
    )
    assert found.system.parameter(found.x, "d.limit") == pytest.approx(1.0 - bound, abs=1e-6)
