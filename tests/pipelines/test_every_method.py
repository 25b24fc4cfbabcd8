"""Every method on every benchmark: the same certified minimum, a plateau that is called one, or a reason."""

from functools import cache

import pytest

from gaitlab.benchmarks.ocp_collection import BENCHMARKS, benchmark
from gaitlab.pipelines.inverse_methods import METHODS
from gaitlab.pipelines.ocp_benchmark import pose_inverse, solve_forward

FAST = next(iter(METHODS))


@cache
def posed(name):
    forward = solve_forward(benchmark(name))
    return pose_inverse(forward, forward.benchmark.simulate(forward.transcribed, forward.result.solution.w))


@cache
def best(name):
    return METHODS[FAST].solve(*posed(name))


@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_fast_path_finds_a_certified_minimum_that_the_data_tell(name):
    result = best(name)
    assert result.converged and result.identifiable.all(), result.reason
    assert result.residuals.max() < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("method", [name for name in METHODS if name != FAST])
@pytest.mark.parametrize("name", BENCHMARKS)
def test_methods_agree_or_say_why_not(name, method):
    result, reference = METHODS[method].solve(*posed(name)), best(name)
    if not result.converged or "do not tell" in result.reason:
        assert result.reason
        return
    assert result.objective == pytest.approx(reference.objective, rel=2e-3)
    # A product of slack and multiplier grows with the weights, here up to 1e4: the smaller of both factors does not.
    assert max(result.residuals.stationarity, result.residuals.primal, result.complementarity) < 1e-5
