"""AUTO-07p's demo `ops`: extremal parameter values along families of periodic orbits.

Source: Doedel and Oldeman, AUTO-07p manual (2012), demo ops (equations in demos/ops/ops.f90; system of Alejandro 1991,
method of Doedel, Keller, Kernevez, Int. J. Bifurc. Chaos 1, 1991):

    x' = (-p4 (x^3 / 3 - x) + (z - x) / p2 - y) / p1,  y' = x - p3,  z' = -(z - x) / p2

From p = (0.5, 4, 0.9, 2) the equilibrium loses stability at a Hopf point; along the family of orbits that begins there
p3 has its first extremum at 0.921972. Then p2 and p1 are released.
"""

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from ..continuation.collocation_mesh import Mesh
from ..continuation.collocation_problem import Segment
from ..continuation.extended_system import ExtendedSystem
from ..continuation.extremum import ExtremumProblem
from ..continuation.path_events import TestFunction
from ..continuation.path_following import Path, PathFollowing
from ..continuation.periodic_start import field_jacobian, hopf_test, small_orbit
from ..continuation.zero_problem import ZeroProblem
from ..errors import NotConverged

NAMES = ("p1", "p2", "p3", "p4")
START = np.array([0.5, 4.0, 0.9, 2.0])
FIRST_EXTREMUM = 0.921972
"""Published p3 at the first extremum."""
FIXED = {"p1": 0.5, "p2": 4.0, "p4": 2.0}


def field(t: ca.SX, x: ca.SX, p: ca.SX) -> ca.SX:
    """Right-hand side of the system."""
    del t  # Unused.
    exchange = (x[2] - x[0]) / p[1]
    return ca.vertcat((-p[3] * (x[0] ** 3 / 3.0 - x[0]) + exchange - x[1]) / p[0], x[0] - p[2], -exchange)


def _standing_still(x: ca.SX, p: ca.SX) -> ca.SX:
    return field(ca.SX(0), x, p)


SEGMENT = Segment(name="orbit", mesh=Mesh.uniform(20), field=field, n_x=3, n_p=4)


@dataclass(frozen=True, kw_only=True)
class OrbitFamily:
    """A point on the family of periodic orbits."""

    segment: Segment
    problem: ZeroProblem


def hopf_point() -> np.ndarray:
    """State and parameters (x, y, z, p1, p2, p3, p4), shape (7,), where orbits begin.

    Raises `NotConverged` where the family of equilibria has none.
    """
    x = np.array([START[2], -START[3] * (START[2] ** 3 / 3.0 - START[2]), START[2]])
    problem = ZeroProblem().add_variables("x", x).add_variables("p", START)
    problem = problem.add_zero("equilibrium", _standing_still, "x", "p")
    system = ExtendedSystem(problem=problem.add_parameters(NAMES, "p"), fixed=FIXED)
    event = TestFunction(name="Hopf", function=lambda u: hopf_test(field_jacobian(field, u[:3], u[3:])), stops=True)
    method = PathFollowing(step=0.01, max_step=0.05)
    rising = system.parameter_gradient(problem.start, "p3")
    path = method.follow(system, problem.start, direction=rising, events=(event,), bounds={"p3": (0.8, 0.95)})
    if not path.events:
        raise NotConverged(f"no Hopf point between p3 = 0.9 and 0.95: {path.reason}")
    return path.events[0].x


def first_orbit(mesh: Mesh, amplitude: float = 0.05) -> OrbitFamily:
    """The family close to its beginning, as a problem whose start is almost an orbit."""
    point = hopf_point()
    orbit = small_orbit(field_jacobian(field, point[:3], point[3:]), point[:3], amplitude, mesh)
    return orbit_problem(mesh, orbit.x, orbit.duration, point[3:])


def orbit_problem(mesh: Mesh, x: np.ndarray, duration: float, p: np.ndarray) -> OrbitFamily:
    """Periodic orbits of the system: states x, shape (n_points, 3), period, parameters p, shape (4,)."""
    segment = replace(SEGMENT, mesh=mesh)
    problem = segment.add_periodicity(segment.add_to(ZeroProblem(), x, duration, p), autonomous=True)
    return OrbitFamily(segment=segment, problem=problem.add_parameters(NAMES, "orbit.p"))


def family(mesh: Mesh, events: tuple[TestFunction, ...] = ()) -> Path:
    """The family in p3 from its beginning, other parameters fixed."""
    start = first_orbit(mesh)
    system = ExtendedSystem(problem=start.problem, fixed=FIXED)
    states, n = start.segment.states(start.problem, start.problem.start), start.problem.n_u
    growing = np.concatenate([(states - states.mean(axis=0)).ravel(), np.zeros(n - states.size)])
    method = PathFollowing(step=0.05, max_step=0.3, max_points=100)
    return method.follow(system, start.problem.start, direction=growing, events=events, bounds={"p3": (0.85, 1.0)})


def auto_ops(n_intervals: int = 20, parameters: tuple[str, ...] = ("p2", "p1")) -> ExtremumProblem:
    """Extremal p3 over the orbits of the family, the mesh adapted before each release.

    Raises `NotConverged` where the family cannot be entered.
    """
    mesh = Mesh.uniform(n_intervals)
    path = family(mesh)
    if len(path.x) < 4:
        raise NotConverged(f"the family of periodic orbits could not be entered: {path.reason}")
    start = first_orbit(mesh)
    return ExtremumProblem(
        problem=start.problem.starting_at(path.x[3]).refreshed(path.x[3]),
        objective="p3",
        parameters=parameters,
        bounds={"p1": (1e-3, 5.0), "p2": (0.1, 20.0), "p3": (0.5, 1.5)},
        remesh=adapted,
    )


def adapted(problem: ZeroProblem, u: np.ndarray) -> ZeroProblem:
    """The problem on a mesh that suits the orbit within u, shape (n_u,)."""
    old = SEGMENT.on_mesh_of(problem)
    x = old.states(problem, u)
    new = old.mesh.adapted(x)
    return orbit_problem(new, old.mesh.transfer(x, new), old.duration(problem, u), old.parameters(problem, u)).problem
