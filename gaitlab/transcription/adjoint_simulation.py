r"""Simulation of an extremal problem with adjoint gradients of its extremal values.

The extremal times :math:`t_i` solve :math:`\dot{h}(t_i) = 0` between the grid points; as they move, the extremal
values do not change to first order, so the gradient of each needs one adjoint sweep from :math:`t_i` back to the start
(Zallinger et al. 2025, (33)-(34)). The sweeps here are those of the discretised equations, which makes the gradients
exact for the simulated values, not only up to the integration error.
"""

from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..ocp.extremal import ExtremalProblem
from .control_spline import ControlSpline
from .interval_functions import IntervalFunctions, interval_functions
from .peaks import Peaks, Probes, find_peaks


@dataclass(frozen=True, kw_only=True, eq=False)
class AdjointSimulation:
    """Simulates a problem for given nodes of the control splines; a minimax problem in those nodes.

    Raises:
        ProblemError: No step per spline interval.
    """

    problem: ExtremalProblem
    spline: ControlSpline = field(default_factory=ControlSpline)
    steps_per_node: int = 5
    """Runge-Kutta steps between two nodes of the spline."""
    guarded: float = 0.5
    """Grid points with outputs in this upper share of their range accompany the maxima (`peaks`)."""

    def __post_init__(self) -> None:
        if self.steps_per_node < 1:
            raise ProblemError(f"at least one step per spline interval is needed, got {self.steps_per_node}")

    @property
    def n_steps(self) -> int:
        """Number of integration steps N."""
        return self.steps_per_node * (self.spline.n_nodes - 1)

    @property
    def step(self) -> float:
        """Length of an integration step [s]."""
        return self.problem.duration / self.n_steps

    @property
    def n_controls(self) -> int:
        """Number of controls."""
        return self.problem.u.numel()

    @cached_property
    def times(self) -> np.ndarray:
        """Grid [s], shape (N + 1,)."""
        return np.linspace(0.0, self.problem.duration, self.n_steps + 1)

    @cached_property
    def lbw(self) -> np.ndarray:
        """Lower bounds of the nodes, shape (n_w,)."""
        return np.tile(self.problem.lower, self.spline.n_nodes)

    @cached_property
    def ubw(self) -> np.ndarray:
        """Upper bounds of the nodes, shape (n_w,)."""
        return np.tile(self.problem.upper, self.spline.n_nodes)

    @cached_property
    def functions(self) -> IntervalFunctions:
        """Functions of one interval."""
        return interval_functions(self.problem, self.step)

    @cached_property
    def stage_matrix(self) -> np.ndarray:
        """Start, middle and end controls of each interval as functions of the nodes, shape (N, 3 n_u, n_w)."""
        matrices = [self.control_matrix(self.times[:-1] + share * self.step) for share in (0.0, 0.5, 1.0)]
        return np.concatenate(matrices, axis=1)

    @cached_property
    def grid_matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """Controls and their slopes at the grid points as functions of the nodes, shapes (N + 1, n_u, n_w)."""
        return self.control_matrix(self.times), self.control_matrix(self.times, 1)

    @cached_property
    def rollout(self) -> ca.Function:
        """All steps: (x0, controls, times) -> states at the ends of the intervals."""
        return self.functions.step.mapaccum(self.n_steps)

    def control_matrix(self, times: np.ndarray, derivative: int = 0) -> np.ndarray:
        """C(t) at times [s], shape (n,); result (n, n_u, n_w)."""
        return self.spline.matrix(self.problem.duration, self.n_controls, times, derivative)

    def evaluate(self, w: np.ndarray) -> "Simulated":
        """Simulate for nodes w, shape (n_w,): ordered by time, all controls of a node together.

        Raises:
            ProblemError: w has another shape.
        """
        if w.shape != self.lbw.shape:
            raise ProblemError(f"the nodes must have shape {self.lbw.shape}, got {w.shape}")
        controls = self.stage_matrix @ w  # (N, 3 n_u)
        after = self.rollout(self.problem.x0, controls.T, self.times[:-1]).full().T
        states = np.vstack([self.problem.x0, after])
        return Simulated(simulation=self, w=w, controls=controls, states=states)


@dataclass(frozen=True, kw_only=True, eq=False)
class Simulated:
    """One simulation, with the values, gradients and curvature that a minimax method asks for."""

    simulation: AdjointSimulation
    w: np.ndarray
    """Nodes, shape (n_w,)."""
    controls: np.ndarray
    """Start, middle and end controls of each interval, shape (N, 3 n_u)."""
    states: np.ndarray
    """States on the grid, shape (N + 1, n_x)."""

    @cached_property
    def peaks(self) -> Peaks:
        """All local maxima of all outputs, refined between the grid points."""
        simulation = self.simulation
        u, du = (matrix @ self.w for matrix in simulation.grid_matrices)
        grid = simulation.functions.grid(self.states.T, u.T, du.T, simulation.times[None])
        outputs, slopes = (out.full().T for out in grid)
        return find_peaks(simulation.functions, self._place, outputs, slopes, simulation.guarded)

    @property
    def values(self) -> np.ndarray:
        """Extremal values h_i, then the guards, shape (n_i,)."""
        return self.peaks.values

    @property
    def is_peak(self) -> np.ndarray:
        """False for guards, shape (n_i,)."""
        return self.peaks.is_peak

    @property
    def measure(self) -> np.ndarray:
        """Weights of the guards in a mean over time, zero for peaks, shape (n_i,)."""
        return self.peaks.measure

    @property
    def equality(self) -> np.ndarray:
        """Final constraints phi, shape (n_phi,)."""
        return self._terminal[0].ravel()

    @cached_property
    def gradients(self) -> np.ndarray:
        """Gradients of the extremal values in the nodes, shape (n_i, n_w): one adjoint each, (33)-(34)."""
        n_i, n_z, peaks = len(self.values), self._jacobians.shape[2], self.peaks
        direct = peaks.gradients[:, None, self.n_x : n_z] @ self.simulation.stage_matrix[peaks.probes.intervals]
        direct += peaks.gradients[:, None, n_z:] @ self._probe_controls
        return direct[:, 0] + np.tensordot(self._adjoints[:, :, :n_i], self._control_effects, ([0, 1], [0, 1]))

    @cached_property
    def equality_jacobian(self) -> np.ndarray:
        """Jacobian of phi in the nodes, shape (n_phi, n_w), (16)."""
        adjoints = self._adjoints[:, :, len(self.values) :]
        return np.tensordot(adjoints, self._control_effects, ([0, 1], [0, 1]))

    def hessian(self, mu: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """Hessian of mu' values + lam' equality in the nodes, shapes (n_i,), (n_phi,); result (n_w, n_w).

        Extremal times move, which adds - (grad dh/dt)(grad dh/dt)' / (d2h/dt2) for each (implicit function theorem).
        """
        functions, peaks = self.simulation.functions, self.peaks
        x = self._sensitivities
        z = np.concatenate([x[:-1], self.simulation.stage_matrix], axis=1)  # (N, n_z, n_w)
        adjoint = self._adjoints @ np.concatenate([mu, lam])  # (N, n_x)
        result = np.tensordot(
            z, _blocks(functions.step_hessian(*self._steps, adjoint.T), z.shape[1]) @ z, ([0, 1], [0, 1])
        )
        result += x[-1].T @ functions.terminal_hessian(self.states[-1], lam).full() @ x[-1]
        active = np.flatnonzero(mu)
        y = np.concatenate([z[peaks.probes.intervals], self._probe_controls], axis=1)[active]
        curvature = _blocks(functions.probe_hessian(*(part[:, active] for part in peaks.probes.inputs)), y.shape[1])
        slopes = peaks.slope_gradients[active]
        curvature -= peaks.inverse_curvatures[active, None, None] * slopes[:, :, None] * slopes[:, None, :]
        return result + np.tensordot(y, mu[active, None, None] * curvature @ y, ([0, 1], [0, 1]))

    @property
    def n_x(self) -> int:
        """Number of states."""
        return self.states.shape[1]

    @property
    def _steps(self) -> tuple[np.ndarray, ...]:
        return self.states[:-1].T, self.controls.T, self.simulation.times[None, :-1]

    @cached_property
    def _jacobians(self) -> np.ndarray:
        """Jacobians of the steps in (x, three controls), shape (N, n_x, n_z)."""
        jacobians = self.simulation.functions.step_jacobian(*self._steps)
        return _blocks(jacobians, jacobians.shape[1] // self.simulation.n_steps)

    @cached_property
    def _control_effects(self) -> np.ndarray:
        """Derivative of each step's end in the nodes, state at its start held, shape (N, n_x, n_w)."""
        return self._jacobians[:, :, self.n_x :] @ self.simulation.stage_matrix

    @cached_property
    def _terminal(self) -> tuple[np.ndarray, np.ndarray]:
        phi, jacobian = self.simulation.functions.terminal(self.states[-1])
        return phi.full(), jacobian.full()

    @cached_property
    def _adjoints(self) -> np.ndarray:
        """Adjoint of the state at the end of each step, shape (N, n_x, n_i + n_phi)."""
        n_i, A = len(self.values), self._jacobians[:, :, : self.n_x]
        seeds = np.zeros((len(A), self.n_x, n_i + len(self.equality)))
        seeds[self.peaks.probes.intervals, :, np.arange(n_i)] = self.peaks.gradients[:, : self.n_x]
        adjoints, adjoint = np.empty_like(seeds), np.zeros(seeds.shape[1:])
        adjoint[:, n_i:] = self._terminal[1].T
        for k in reversed(range(len(A))):
            adjoints[k] = adjoint
            adjoint = A[k].T @ adjoint + seeds[k]
        return adjoints

    @cached_property
    def _sensitivities(self) -> np.ndarray:
        """Derivatives of the states on the grid in the nodes, shape (N + 1, n_x, n_w)."""
        A, effects = self._jacobians[:, :, : self.n_x], self._control_effects
        result = np.zeros((len(A) + 1, *effects.shape[1:]))
        for k in range(len(A)):
            result[k + 1] = A[k] @ result[k] + effects[k]
        return result

    @cached_property
    def _probe_controls(self) -> np.ndarray:
        """Control and its slope at the peaks as functions of the nodes, shape (n_i, 2 n_u, n_w)."""
        times = self.peaks.times
        return np.concatenate([self.simulation.control_matrix(times, order) for order in (0, 1)], axis=1)

    def _place(self, intervals: np.ndarray, components: np.ndarray, shares: np.ndarray) -> Probes:
        starts = self.simulation.times[intervals]
        times = starts + shares * self.simulation.step
        spline, nodes = self.simulation.spline, self.w.reshape(self.simulation.spline.n_nodes, -1)
        duration = self.simulation.problem.duration
        u, du, ddu = (spline.controls(duration, nodes, times, order) for order in range(3))
        return Probes(
            intervals=intervals,
            components=components,
            shares=shares,
            y=np.hstack([self.states[intervals], self.controls[intervals], u, du]),
            ddu=ddu,
            starts=starts,
            step=self.simulation.step,
            selection=np.eye(self.simulation.problem.outputs.numel())[components],
        )


def _blocks(horizontal: ca.DM, width: int) -> np.ndarray:
    """Matrices that stand side by side, (rows, n width), as an array (n, rows, width)."""
    array = horizontal.full()
    return np.moveaxis(array.reshape(len(array), -1, width), 1, 0)
