"""Optimal periodic orbits with known answers: one orbit, and two glued ones."""

import numpy as np
import pytest

from gaitlab.benchmarks.forced_oscillator import amplitude_difference, fastest_start, largest_difference
from gaitlab.continuation.extremum import Kind, SuccessiveContinuation

METHOD = SuccessiveContinuation()


def test_fastest_start():
    found = METHOD.solve(fastest_start())
    assert found.converged, found.reason
    assert found.kind is Kind.MAXIMUM
    assert found.parameters == pytest.approx({"velocity": 1.0, "k": 1.0, "phase": 0.0, "w": 1.0}, abs=1e-7)


def test_optimum_converges_with_its_order():
    errors = [abs(METHOD.solve(fastest_start(n)).objective - 1.0) for n in (4, 8)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=0.5)


def test_glued_orbits():
    found = METHOD.solve(amplitude_difference())
    frequency, difference = largest_difference()
    assert found.converged, found.reason
    assert found.objective == pytest.approx(difference, abs=1e-8)
    assert found.parameters["w"] == pytest.approx(frequency, abs=1e-6)


def test_each_glued_orbit_has_its_own_adjoint_system():
    problem = amplitude_difference().problem
    assert {"slow.orbit.collocation", "fast.orbit.collocation", "same k", "detuning"} <= set(problem.rows)
