"""Rocket car: as far as possible with little fuel in little time.

Hatz (2014), (14.1)-(14.3), Tables 14.1 and 14.2, and chapter 6. Time is real time here instead of the transformed one;
the control value q_0 is the duration.
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

DISTANCE = 10.0
END_VELOCITY = 1.0


def rocket_car_problem() -> MultiStageProblem:
    r"""Position z, velocity v, mass m; thrust u in [-1, 1].

    .. math:: \min -\theta_1 m(T) + \theta_2 T, \quad \dot z = v, \; \dot v = (u - p_1 v^2) / m, \; \dot m = -p_2 u^2
    """
    z, v, m = ca.SX.sym("z"), ca.SX.sym("v"), ca.SX.sym("m")
    u, duration = ca.SX.sym("u"), ca.SX.sym("duration")
    p1, p2 = ca.SX.sym("p1"), ca.SX.sym("p2")
    end = np.array([DISTANCE, END_VELOCITY, np.inf])
    stage = Stage(
        name="drive",
        x=ca.vertcat(z, v, m),
        u=u,
        ode=ca.vertcat(v, (u - p1 * v**2) / m, -p2 * u**2),
        duration=duration,
        mayer={"mass": -m, "time": duration},
        u_bounds=Bounds.symmetric(1.0),
        start=fixed(0.0, 0.0, 1.0),
        end=Bounds(lower=np.where(np.isfinite(end), end, -np.inf), upper=end),
    )
    return MultiStageProblem(
        stages=(stage,),
        q=duration,
        q_bounds=Bounds(lower=np.array([0.1]), upper=np.array([50.0])),
        p=ca.vertcat(p1, p2),
    )


def rocket_car() -> Benchmark:
    """Setting of Tables 14.1 and 14.2."""
    problem = rocket_car_problem()
    return Benchmark(
        name="rocket-car",
        title="Rocket car",
        source="Hatz (2014), (14.1)-(14.3). The end velocity 1 of (9.5), (6.9) and (14.1) is the one that "
        "reproduces the optimum; (6.31) prints v(0) = 1 and v(1) = 0.",
        problem=problem,
        method=MultipleShooting(grids=20, integrator=RungeKutta4(n_steps=4)),
        truth=problem.parameters({"mass": 0.5, "time": 0.5, "p1": 0.1, "p2": 0.1}),
        start=straight_line(problem, np.array([5.0])),
        observations=(
            Observation(
                name="states",
                function=problem.stages[0].x,
                times=np.linspace(0.0, 1.0, 21),
                sd=0.05 * np.array([5.0, 1.5, 0.7]),
            ),
        ),
        unknowns=Unknowns(
            names=("mass", "p1", "p2"),
            guess=np.array([0.7, 0.15, 0.15]),
            lower=np.array([0.0, 0.01, 0.01]),
            upper=np.array([5.0, 1.0, 0.5]),
        ),
        published=PublishedOptimum(duration=5.2663, objective=2.3906, remark="reproduced to all printed digits"),
        published_estimate=PublishedEstimate(
            estimates={"mass": 5.7131e-1, "p1": 9.5561e-2, "p2": 1.0532e-1},
            objective=24.714,
            duration=5.2265,
            seconds=8.8791,
            iterations=145,
        ),
    )
