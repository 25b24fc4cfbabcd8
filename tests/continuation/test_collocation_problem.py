"""Trajectories: convergence orders, integrals, periodicity, and malformed segments."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.benchmarks.forced_oscillator import orbit, steady_state
from gaitlab.benchmarks.limit_cycle import cycle
from gaitlab.continuation.collocation_mesh import Mesh
from gaitlab.continuation.collocation_problem import Segment
from gaitlab.continuation.extended_system import ExtendedSystem
from gaitlab.continuation.path_following import PathFollowing
from gaitlab.continuation.staged_function import Role
from gaitlab.continuation.zero_problem import ZeroProblem
from gaitlab.errors import ProblemError

P = np.array([3.0, 0.4, 1.3])
METHOD = PathFollowing(tol=1e-12)


def orbit_error(mesh):
    """Errors of the steady state at the knots and at all base points."""
    segment, problem = orbit(mesh, P)
    problem = problem.add_parameters(("k", "phase", "w"), "orbit.p")
    system = ExtendedSystem(problem=problem, fixed={"phase": P[1], "w": P[2]})
    # Least-norm corrections may move k a little: the truth is taken at the k found.
    u = METHOD.correct(system, system.first_point())
    error = np.abs(segment.states(problem, u) - steady_state(mesh.points, segment.parameters(problem, u)))
    return error[:: mesh.degree].max(), error.max()


@pytest.mark.parametrize("degree", [2, 3])
def test_convergence_orders(degree):
    """2 m at the knots and m + 1 (m + 2 at the symmetric midpoint of degree 2) between them."""
    coarse, fine = (orbit_error(Mesh.uniform(n, degree)) for n in (12, 24))
    at_knots, between = np.log2(np.array(coarse) / np.array(fine))
    assert at_knots == pytest.approx(2 * degree, abs=0.3)
    assert between >= degree + 0.7


def test_uneven_meshes_solve_too():
    mesh = Mesh(knots=np.array([0.0, 0.05, 0.2, 0.3, 0.45, 0.6, 0.65, 0.8, 1.0]), degree=5)
    assert orbit_error(mesh)[0] < 1e-7
    segment, problem = orbit(mesh, P)
    np.testing.assert_allclose(segment.on_mesh_of(problem).mesh.knots, mesh.knots, atol=1e-15)


def test_multipliers_are_samples_of_the_adjoint_trajectory():
    """x' = -x from 1: the derivative of x(T) in the state at time t is exp(t - T)."""
    mesh = Mesh.uniform(4, degree=3)
    segment = Segment(name="s", mesh=mesh, field=lambda t, x, p: -x, n_x=1, n_p=0)
    problem = segment.add_to(ZeroProblem(), np.exp(-mesh.points)[:, None], 1.0, np.zeros(0))
    problem = segment.add_ends(problem, "ends", lambda first, last, T, p: ca.vertcat(first - 1, T - 1))
    problem = segment.add_ends(problem, "last", lambda first, last, T, p: last, Role.MONITOR)
    entries = problem.jacobian(problem.start)
    J = np.zeros((problem.n_rows, problem.n_u))
    np.add.at(J, (entries.rows, entries.cols), entries.values)
    objective = problem.rows["last"].start
    others = [i for i in range(problem.n_rows) if i != objective]
    multipliers = np.linalg.lstsq(J[others].T, -J[objective], rcond=None)[0]
    times = (mesh.knots[:-1, None] + mesh.widths[:, None] * mesh.gauss[0]).ravel()
    np.testing.assert_allclose(multipliers[problem.rows["s.collocation"]], -np.exp(times - 1.0), rtol=1e-4)


def test_integrals():
    mesh = Mesh(knots=np.array([0.0, 0.3, 1.0]), degree=3)
    segment = Segment(name="s", mesh=mesh, field=lambda t, x, p: x, n_x=1, n_p=1)
    problem = segment.add_to(ZeroProblem(), mesh.points[:, None], 2.0, np.array([5.0]))
    problem = segment.add_integral(problem, "integral", lambda t, x, p: p * t * x)
    problem = segment.add_integral(problem, "mean", lambda t, x, p: x**2, mean=True)
    values = {n: problem.stage(n).values(problem.start)[0] for n in ("integral", "mean")}
    assert values == pytest.approx({"integral": 5.0 * 4.0 / 3.0, "mean": 1.0 / 3.0})


def test_phase_refers_to_the_orbit_itself():
    _, problem = cycle(Mesh.uniform(6), np.array([0.6, -0.2]))
    row = problem.rows["orbit.phase"]
    u = problem.start + 0.1
    assert np.abs(problem.values(u)[row]) < 1e-12  # A shift of the whole orbit is no shift in time.
    turned = problem.start.copy()
    states = turned[problem.indices("orbit.x")].reshape(-1, 2)
    turned[problem.indices("orbit.x")] = (states + 0.1 * np.column_stack([-states[:, 1], states[:, 0]])).ravel()
    assert abs(problem.values(turned)[row][0]) > 0.1
    assert abs(problem.refreshed(turned).values(turned)[row][0]) < 1e-12


def test_malformed_segments():
    mesh = Mesh.uniform(2)
    segment = Segment(name="s", mesh=mesh, field=lambda t, x, p: ca.vertcat(x, x), n_x=1, n_p=0)
    with pytest.raises(ProblemError, match="segment 's' needs states of shape"):
        segment.add_to(ZeroProblem(), np.zeros((3, 1)), 1.0, np.zeros(0))
    with pytest.raises(ProblemError, match="must return 1 numbers, got 2"):
        segment.add_to(ZeroProblem(), np.zeros((9, 1)), 1.0, np.zeros(0))
