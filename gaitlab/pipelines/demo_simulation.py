r"""Forward simulation of the optimal arcs: an adaptive Runge-Kutta method of order 8 in place of collocation.

From every node of the fine grid, the optimal joint torques, linear in the interval, drive the body to the next node:

.. math:: M \dot v + h = \tau + J' f, \quad J \dot v + \dot J v = -2 \kappa J v - \kappa^2 (y - y_0),

where J are the rates of the contact coordinates in contact, y_0 their places at landing, and the forces f follow from
the constraints (Baumgarte 1972). A light foot that carries the body on one point is an inverted pendulum with a rate of
some 100 1/s, so that a simulation without feedback over a whole arc would only amplify rounding errors; between two
nodes nothing of the collocated trajectory but the torques enters. The defects at the
nodes are reported, and spread evenly over the interval, so that the path is continuous.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from ..errors import NotConverged
from ..multibody.dynamics import contact_positions, contact_velocities, inverse_dynamics, layout_of, parameter_vector
from ..multibody.subject import SubjectModel
from ..transcription.hermite import GAUSS_POINTS
from ..transcription.mechanical_problem import MechanicalProblem
from ..walking.model import POINTS, ROOT
from .demo_optimum import OptimalArc
from .demo_recording import PLATE_RATE
from .demo_tracking import INTERVAL

STABILISATION = 100.0  # [1/s], kappa
TOLERANCE = 1e-9


@dataclass(frozen=True, kw_only=True)
class SimulatedArc:
    """One arc at `PLATE_RATE`, without its end."""

    q: np.ndarray
    """Coordinates [m, rad], shape (n, n_q)."""
    forces: np.ndarray
    """Forces of the floor on `POINTS` [N], shape (n, 4, 3)."""
    defect: float
    """Largest difference of the coordinates at the end of an interval from those of the next node [m, rad]."""


class ForwardDynamics:
    """Accelerations and contact forces of a subject."""

    def __init__(self, subject: SubjectModel) -> None:
        layout, p = layout_of(subject), ca.SX(parameter_vector(subject))
        q, v = ca.SX.sym("q", layout.n_q), ca.SX.sym("v", layout.n_q)
        a = ca.SX.sym("a", layout.n_q)
        generalised = inverse_dynamics(layout, p, q, v, a, {})
        positions, velocities = contact_positions(layout, p, q), contact_velocities(layout, p, q, v)
        y = ca.vertcat(*[positions[name] for name in POINTS])
        rate = ca.vertcat(*[velocities[name] for name in POINTS])
        bias = ca.substitute(generalised, a, ca.SX.zeros(layout.n_q))
        drift = ca.jtimes(rate, q, v)
        outputs = [ca.jacobian(generalised, a), bias, ca.jacobian(rate, v), drift, y, rate]
        self._terms = ca.Function("terms", [q, v], [ca.densify(o) for o in outputs])
        self.n_q = layout.n_q

    def places(self, q: np.ndarray) -> np.ndarray:
        """Contact coordinates of q (n_q,) [m], shape (12,)."""
        return np.asarray(self._terms(q, np.zeros(self.n_q))[4]).ravel()

    def __call__(
        self, state: np.ndarray, torques: np.ndarray, active: list[int], held: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Accelerations (n_q,) and all contact force components (12,) [N].

        Args:
            state: (q, v), shape (2 n_q,).
            torques: Of the joints [N*m], shape (n_q - 6,).
            active: Contact coordinates that stay.
            held: Where they stay [m], shape (12,).
        """
        n = self.n_q
        mass, bias, jacobian, drift, y, rate = (np.asarray(x) for x in self._terms(state[:n], state[n:]))
        J = jacobian[active]
        pull = -2 * STABILISATION * rate.ravel() - STABILISATION**2 * (y.ravel() - held)
        top = np.concatenate([np.zeros(ROOT), torques]) - bias.ravel()
        matrix = np.block([[mass, -J.T], [J, np.zeros((len(active), len(active)))]])
        solution = np.linalg.solve(matrix, np.concatenate([top, (pull - drift.ravel())[active]]))
        forces = np.zeros(len(held))
        forces[active] = solution[n:]
        return solution[:n], forces


def simulate_arc(dynamics: ForwardDynamics, arc: OptimalArc) -> SimulatedArc:
    """Integrate every interval of an arc from its node under its torques."""
    n_q, torques, nodes = dynamics.n_q, torques_at_nodes(arc.problem, arc.solution.w), arc.states
    before, node, defect = set[int](), 0, 0.0
    held = np.zeros(3 * len(POINTS))
    times = np.arange(round(INTERVAL * PLATE_RATE) + 1) / PLATE_RATE
    q, forces = list[np.ndarray](), list[np.ndarray]()
    for stage in arc.stages:
        landed = [i for i in stage.active if i not in before]
        held[landed] = dynamics.places(nodes[node, :n_q])[landed]
        before = set(stage.active)
        contact = Contact(active=list(stage.active), held=held.copy())
        for _ in range(stage.n_intervals):
            path, carried = integrate(dynamics, contact, nodes[node], torques[node], times)
            node += 1
            gap = nodes[node, :n_q] - path[-1, :n_q]
            defect = max(defect, float(np.max(np.abs(gap))))
            q.append((path[:, :n_q] + np.linspace(0.0, 1.0, len(path))[:, None] * gap)[:-1])
            forces.append(carried)
    return SimulatedArc(q=np.concatenate(q), forces=np.concatenate(forces).reshape(-1, len(POINTS), 3), defect=defect)


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Contact coordinates that stay, and where."""

    active: list[int]
    held: np.ndarray
    """[m], shape (12,)."""


def torques_at_nodes(problem: MechanicalProblem, w: np.ndarray) -> np.ndarray:
    """Joint torques [N*m] of w (n_w,) at both ends of an interval, on the line through its Gauss points, (N, 2, n)."""
    n_q = problem.shared.layout.n_q
    at_points = problem.outputs(w)[:, ROOT:n_q].reshape(-1, 2, n_q - ROOT)
    slope = (at_points[:, 1] - at_points[:, 0]) / (GAUSS_POINTS[1] - GAUSS_POINTS[0])
    start = at_points[:, 0] - GAUSS_POINTS[0] * slope
    return np.stack([start, start + slope], axis=1)


def integrate(
    dynamics: ForwardDynamics, contact: Contact, state: np.ndarray, torques: np.ndarray, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Motion from a state (2 n_q,) under joint torques that are linear in time, given at the first and the last time.

    Args:
        dynamics: Of the body.
        contact: What stays where it is.
        state: (q, v) at the first time [m, rad, 1/s], shape (2 n_q,).
        torques: At the first and the last time [N*m], shape (2, n_q - 6).
        times: From zero on [s], shape (n + 1,).

    Returns:
        States, shape (n + 1, 2 n_q), and contact forces [N] at all times but the last, shape (n, 12).

    Raises:
        NotConverged: The method cannot keep its tolerance.
    """
    duration = float(times[-1])

    def drive(t: float) -> np.ndarray:
        return torques[0] + t / duration * (torques[1] - torques[0])

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        return np.concatenate([x[dynamics.n_q :], dynamics(x, drive(t), contact.active, contact.held)[0]])

    path = solve_ivp(rate, (0.0, duration), state, "DOP853", times, rtol=TOLERANCE, atol=TOLERANCE)
    if not path.success:
        raise NotConverged(f"a demo arc could not be integrated: {path.message}")
    states = path.y.T
    forces = [
        dynamics(x, drive(t), contact.active, contact.held)[1] for t, x in zip(times[:-1], states[:-1], strict=True)
    ]
    return states, np.array(forces)
