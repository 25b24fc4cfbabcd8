"""The oscillator of Zallinger et al. (2025): published values, and the linear program that it is."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.signal import lsim

from gaitlab.benchmarks.one_mass_oscillator import (
    DAMPING,
    PUBLISHED_P_NORM_PEAK,
    PUBLISHED_PEAK,
    STIFFNESS,
    one_mass_oscillator,
    reaction_force,
)
from gaitlab.nlp.goal_attainment import GoalAttainment
from gaitlab.nlp.minimax import MinimaxStatus
from gaitlab.nlp.p_norm import PNorm
from gaitlab.transcription.adjoint_simulation import AdjointSimulation


@pytest.fixture(scope="module")
def simulation():
    return AdjointSimulation(problem=one_mass_oscillator(), steps_per_node=10)


@pytest.fixture(scope="module")
def solution(simulation):
    return GoalAttainment().solve(simulation, np.zeros(20))


def test_published_peak(solution):
    assert solution.status is MinimaxStatus.SOLVED
    assert solution.is_minimum
    assert solution.n_largest == 8
    assert reaction_force(solution.value) == pytest.approx(PUBLISHED_PEAK, abs=5e-4)


def test_linear_program_with_another_integrator(simulation, solution):
    """min gamma, -gamma <= F(t) <= gamma, on a grid of 1900 intervals with exact exponentials."""
    times = np.linspace(0.0, 0.9, 1901)
    system = (np.array([[0, 1], [-STIFFNESS, -DAMPING]]), np.array([[0], [1.0]]), np.eye(2), np.zeros((2, 1)))
    basis = simulation.control_matrix(times)[:, 0].T
    states = np.array([lsim(system, u, times)[1] for u in basis])  # (20, 1901, 2)
    F = (states @ [STIFFNESS, DAMPING]).T
    rows = np.block([[F, -np.ones((len(F), 1))], [-F, -np.ones((len(F), 1))]])
    end = np.hstack([states[:, -1].T, np.zeros((2, 1))])
    optimum = linprog(
        np.eye(21)[20], rows, np.zeros(len(rows)), end, [1.0, 0.0], bounds=[(-16, 16)] * 20 + [(None, None)]
    )
    assert reaction_force(solution.value) == pytest.approx(optimum.fun, abs=2e-6)


def test_published_start(simulation):
    """The least control that meets the final state peaks at 1.504 N, which decides the ends of the spline."""
    point = simulation.evaluate(np.zeros(20))
    w = np.linalg.lstsq(point.equality_jacobian, -point.equality)[0]
    assert reaction_force(simulation.evaluate(w).values.max()) == pytest.approx(1.504, abs=5e-4)


def test_p_norm(simulation, solution):
    smooth = PNorm().solve(simulation, np.zeros(20))
    assert smooth.status is MinimaxStatus.SOLVED
    assert solution.value < smooth.value
    assert reaction_force(smooth.value) <= PUBLISHED_P_NORM_PEAK
