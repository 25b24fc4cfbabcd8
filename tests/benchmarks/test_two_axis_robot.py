"""The robot of Zallinger et al. (2025): published values, and energies as a check of the equations of motion."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.benchmarks.two_axis_robot import CENTRE, INERTIAS, MASSES, PUBLISHED_PEAK, tool_speed, two_axis_robot
from gaitlab.nlp.goal_attainment import GoalAttainment
from gaitlab.nlp.minimax import MinimaxStatus
from gaitlab.transcription.adjoint_simulation import AdjointSimulation


def test_published_peak():
    simulation = AdjointSimulation(problem=two_axis_robot())
    solution = GoalAttainment().solve(simulation, np.zeros(40))
    assert solution.status is MinimaxStatus.SOLVED
    assert solution.is_minimum
    assert solution.n_largest == 7
    assert tool_speed(solution.value) == pytest.approx(PUBLISHED_PEAK, abs=5e-4)


def test_power_of_the_motors_is_the_rate_of_the_kinetic_energy():
    problem = two_axis_robot()
    x, u = problem.x, problem.u
    first = CENTRE * ca.vertcat(ca.cos(x[0]), ca.sin(x[0]))
    elbow = 2.0 * first
    second = elbow + CENTRE * ca.vertcat(ca.cos(x[1]), ca.sin(x[1]))
    tool = 2.0 * second - elbow
    speeds = [ca.jtimes(point, x[:2], x[2:]) for point in (first, second, tool)]
    energy = sum(0.5 * m * ca.sumsqr(v) for m, v in zip(MASSES, speeds, strict=True))
    energy += sum(0.5 * J * x[2 + i] ** 2 for i, J in enumerate(INERTIAS))
    power = u[0] * x[2] + u[1] * (x[3] - x[2])
    balance = ca.Function("balance", [x, u], [ca.jtimes(energy, x, problem.dynamics) - power])
    generator = np.random.default_rng(0)
    for _ in range(5):
        assert float(balance(generator.normal(size=4), generator.normal(size=2))) == pytest.approx(0.0, abs=1e-12)
