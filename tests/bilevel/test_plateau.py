"""The fit of the rocket car has a plateau where its optimal control is determined by the end conditions."""

from dataclasses import replace

import numpy as np
import pytest

from gaitlab.benchmarks.ocp_collection import benchmark
from gaitlab.bilevel.bundle import Bundle
from gaitlab.bilevel.gauss_newton import GaussNewton
from gaitlab.bilevel.inverse_result import InverseStatus
from gaitlab.bilevel.plateau import OffThePlateau, put_back
from gaitlab.pipelines.ocp_benchmark import pose_inverse, solve_forward


@pytest.fixture(scope="module")
def posed():
    forward = solve_forward(benchmark("rocket-car"))
    measurements = forward.benchmark.simulate(forward.transcribed, forward.result.solution.w)
    return pose_inverse(forward, measurements)


@pytest.fixture(scope="module")
def stranded(posed):
    """A search that starts on the plateau and cannot leave it."""
    problem, w0, p0 = posed
    return GaussNewton().solve(problem, w0, np.array([0.1, *p0[1:]]))


def test_an_end_on_the_plateau_says_so(stranded):
    assert stranded.converged and not stranded.identifiable[0]
    assert "the measurements do not tell mass" in stranded.reason


def test_a_second_search_from_the_first_value_finds_the_valley(posed, stranded):
    problem, w0, p0 = posed
    found = GaussNewton().solve(problem, w0, p0)
    assert found.objective < stranded.objective - 0.3
    assert found.identifiable.all()
    bundle = OffThePlateau(method=Bundle()).solve(problem, w0, p0)
    assert bundle.objective == pytest.approx(found.objective, abs=1e-4)


def test_only_what_is_not_told_is_put_back(stranded):
    p0 = stranded.p + 1.0
    np.testing.assert_array_equal(put_back(stranded, p0), [p0[0], *stranded.p[1:]])
    assert put_back(stranded, stranded.p) is None
    assert put_back(replace(stranded, status=InverseStatus.STALLED), p0) is None
