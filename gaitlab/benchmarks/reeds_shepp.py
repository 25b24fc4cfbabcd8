"""Reeds-Shepp car: from one pose in the plane to another, forwards or backwards.

Hatz (2014), (14.7)-(14.9), Tables 14.5 and 14.6; with measured controls (14.15), Tables 14.11 and 14.13.
"""

import casadi as ca
import numpy as np

from ..ocp.constraint import Bounds
from ..ocp.problem import MultiStageProblem
from ..ocp.stage import Stage, fixed
from ..ocp.trajectory import straight_line
from ..transcription.integrators import RungeKutta4
from ..transcription.multiple_shooting import MultipleShooting
from .definition import Benchmark, Observation, PublishedEstimate, PublishedOptimum, Unknowns

N_INTERVALS = 20


def reeds_shepp_problem() -> MultiStageProblem:
    r"""Position (x_0, x_1), heading x_2; speed u_0 and turning rate u_1 in [-1, 1].

    .. math:: \min \theta_1 T + \int_0^T \theta_2 u_0^2 + \theta_3 u_1^2 \, dt, \quad
        \dot x_0 = u_0 \cos x_2, \; \dot x_1 = u_0 \sin x_2, \; \dot x_2 = u_1
    """
    x, u, duration = ca.SX.sym("x", 3), ca.SX.sym("u", 2), ca.SX.sym("duration")
    stage = Stage(
        name="path",
        x=x,
        u=u,
        ode=ca.vertcat(u[0] * ca.cos(x[2]), u[0] * ca.sin(x[2]), u[1]),
        duration=duration,
        mayer={"time": duration},
        lagrange={"speed": u[0] ** 2, "turning": u[1] ** 2},
        u_bounds=Bounds.symmetric(1.0, 1.0),
        start=fixed(0.0, 0.0, np.pi / 2),
        end=fixed(1.0, 1.0, 1.0),
    )
    bounds = Bounds(lower=np.array([0.1]), upper=np.array([50.0]))
    return MultiStageProblem(stages=(stage,), q=duration, q_bounds=bounds)


def reeds_shepp() -> Benchmark:
    """Setting of Tables 14.5 and 14.6: states are measured."""
    problem = reeds_shepp_problem()
    return _benchmark(
        problem,
        "reeds-shepp",
        (_states(problem),),
        PublishedEstimate(
            estimates={"time": 3.0932e-1, "speed": 3.4398e-1},
            objective=26.106,
            duration=2.2101,
            seconds=2.3945,
            iterations=102,
        ),
    )


def reeds_shepp_with_controls() -> Benchmark:
    """Setting of (14.15), Tables 14.11 and 14.13: states and controls are measured."""
    problem = reeds_shepp_problem()
    controls = Observation(
        name="controls",
        function=problem.stages[0].u,
        times=np.linspace(0.0, 1.0, N_INTERVALS + 1)[:-1],
        sd=0.05 * np.array([0.5, 0.2]),
    )
    return _benchmark(
        problem,
        "reeds-shepp-controls",
        (_states(problem), controls),
        PublishedEstimate(
            estimates={"time": 3.3404e-1, "speed": 3.3570e-1},
            objective=4.3929e-1,
            duration=2.1157,
            seconds=3.2799,
            iterations=123,
            other_seconds={"derivative-free": 69.023, "bundle": 506.12},
            remark="its noise is not published; the printed sum of squares of 103 residuals says that it was smaller "
            "than stated",
        ),
    )


def _states(problem: MultiStageProblem) -> Observation:
    return Observation(
        name="states",
        function=problem.stages[0].x,
        times=np.linspace(0.0, 1.0, N_INTERVALS + 1),
        sd=0.05 * np.array([0.6, 0.6, 1.0]),
    )


def _benchmark(
    problem: MultiStageProblem, name: str, observations: tuple[Observation, ...], estimate: PublishedEstimate
) -> Benchmark:
    third = 1.0 / 3.0
    return Benchmark(
        name=name,
        title="Reeds-Shepp car" + (" (states and controls measured)" if len(observations) > 1 else ""),
        source="Hatz (2014), (14.7); inverse problem (14.15)"
        if len(observations) > 1
        else "Hatz (2014), (14.7)-(14.9)",
        problem=problem,
        method=MultipleShooting(grids=N_INTERVALS, integrator=RungeKutta4(n_steps=2)),
        truth=problem.parameters({"time": third, "speed": third, "turning": third}),
        start=straight_line(problem, np.array([2.0])),
        observations=observations,
        unknowns=Unknowns(
            names=("time", "speed"), guess=np.array([1.0, 0.1]), lower=np.zeros(2), upper=np.array([20.0, 20.0])
        ),
        published=PublishedOptimum(
            duration=2.1140,
            objective=1.4247,
            remark="the printed objective is above our certified minimum 1.42459: the printed point is not converged",
        ),
        published_estimate=estimate,
    )
