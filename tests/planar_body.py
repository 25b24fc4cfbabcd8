"""A rigid body in the plane on two point feet: the smallest mechanical model with everything that walking has."""

import casadi as ca
import numpy as np

from gaitlab.ocp.mechanical import ContactStage, MechanicalModel
from gaitlab.transcription.mechanical_functions import point_functions
from gaitlab.transcription.mechanical_layout import Boundary, MechanicalLayout
from gaitlab.transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure

PARAMETERS = np.array([2.0, 0.3, 9.81])
"""Mass [kg], moment of inertia [kg*m^2], gravity [m/s^2]."""
FEET = np.array([[-0.4, -0.5], [0.3, -0.5]])
"""In the body's axes [m]."""
FRICTION = 0.8


def planar_body():
    """Coordinates (x, z, angle); forces (x, z) of the rear and the front foot; only a torque acts besides."""
    q, v, a = (ca.SX.sym(name, 3) for name in "qva")
    f, p, d, y = ca.SX.sym("f", 4), ca.SX.sym("p", 3), ca.SX.sym("d", 1), ca.SX.sym("y", 4)
    rotation = ca.blockcat([[ca.cos(q[2]), -ca.sin(q[2])], [ca.sin(q[2]), ca.cos(q[2])]])
    levers = [rotation @ foot for foot in FEET]
    force = [f[:2], f[2:]]
    moment = sum(r[0] * g[1] - r[1] * g[0] for r, g in zip(levers, force, strict=True))
    balance = p[0] * (a[:2] + ca.vertcat(0, p[2])) - force[0] - force[1]
    positions = ca.vertcat(*[q[:2] + r for r in levers])
    return MechanicalModel(
        q=q,
        v=v,
        a=a,
        f=f,
        p=p,
        d=d,
        outputs=ca.vertcat(balance, p[1] * a[2] - moment, q[0] * ca.cos(q[2])),
        n_residual=2,
        y=y,
        criteria=ca.vertcat(y[2] ** 2, d * y[3] ** 2 * ca.exp(v[0]), (y[2] * v[2]) ** 2 + p[0] * v[1] ** 4),
        positions=positions,
        velocities=ca.jtimes(positions, q, v),
    )


def cone(*feet):
    """Unilateral contact and friction of the feet that stand."""
    rows = np.zeros((0, 4))
    for foot in feet:
        for x, z in ((0, 1), (1, FRICTION), (-1, FRICTION)):
            row = np.zeros(4)
            row[2 * foot : 2 * foot + 2] = x, z
            rows = np.vstack([rows, row])
    return rows


def stage(duration, n, *feet, **options):
    """A stage in which the named feet stand: the second one only resists sinking where both stand."""
    components = [2 * foot + i for foot in feet for i in (0, 1)]
    active = tuple(c for c in components if len(feet) < 2 or c != 2)
    settings = {"landing": (), "grounded": (), "clear": (), "data": np.ones(1)} | options
    rows = cone(*feet)
    if len(feet) == 2:
        rows = np.array([row for row in rows if row[2] == 0.0])
    return ContactStage(duration=duration, n_intervals=n, active=active, force_cone=rows, **settings)


def steps():
    """Rear foot; flight; landing on both feet."""
    return (
        stage(0.3, 2, 0, clear=(3,), data=np.array([0.5])),
        stage(0.1, 1, clear=(1, 3)),
        stage(0.2, 2, 0, 1, landing=(0, 1, 3), grounded=(1, 3), data=np.array([2.0])),
    )


FUNCTIONS = point_functions(planar_body())


def layout(stages, **options):
    return MechanicalLayout(stages, n_q=3, n_f=4, n_r=2, **({"boundary": Boundary()} | options))


def data(n_nodes, **options):
    zero = np.zeros((n_nodes, 6))
    settings = {
        "p": PARAMETERS,
        "theta": np.array([1.0, 0.0, 0.0]),
        "reference": zero,
        "tracking": zero,
        "given": zero,
        "lower": np.full(3, -1.0),
        "upper": np.full(3, 1.0),
        "acceleration_weights": np.zeros(3),
    }
    return MechanicalData(**(settings | options))


def problem(layout, **options):
    return MechanicalProblem(MechanicalStructure(layout, FUNCTIONS), data(layout.n_intervals + 1, **options))
