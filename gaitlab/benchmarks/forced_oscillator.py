"""Periodic orbits of a forced linear oscillator: optima known by formula, of one orbit and of two glued orbits.

x'' + x' + k x = cos(w t + phase). The steady state has the complex amplitude 1 / (k - w^2 + i w), times exp(i phase).

* One orbit, w = 1: the velocity at t = 0 is largest, and one, at k = 1 and phase 0 (the family is that of the example
  `linode` of COCO, the continuation package of the seed's authors).
* Two orbits at frequencies w and w + 0.1, each a problem of its own, glued: the difference of their amplitudes is
  extremal where the resonance curve is equally steep at both (COCO's example of inflection points of a resonance
  curve). This is the structure of the seed's dynamic-range problem: several orbits, conditions between them, an
  objective that relates them.
"""

import casadi as ca
import numpy as np
from scipy.optimize import brentq

from ..continuation.collocation_mesh import Mesh
from ..continuation.collocation_problem import Segment
from ..continuation.extremum import ExtremumProblem
from ..continuation.staged_function import Role
from ..continuation.zero_problem import ZeroProblem

DETUNING = 0.1
"""Difference of the two frequencies."""


def steady_state(tau: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Exact (x, x') at tau = w t / (2 pi), shape (n,), for p = (k, phase, w); result (n, 2)."""
    k, phase, w = p
    z = np.exp(1j * (2.0 * np.pi * tau + phase)) / (k - w**2 + 1j * w)
    return np.column_stack([z.real, (1j * w * z).real])


def orbit(mesh: Mesh, p: np.ndarray) -> tuple[Segment, ZeroProblem]:
    """Steady states of the oscillator, starting at p = (k, phase, w), shape (3,)."""
    segment = Segment(
        name="orbit",
        mesh=mesh,
        field=lambda t, x, p: ca.vertcat(x[1], -p[0] * x[0] - x[1] + ca.cos(p[2] * t + p[1])),
        n_x=2,
        n_p=3,
    )
    problem = segment.add_to(ZeroProblem(), steady_state(mesh.points, p), 2.0 * np.pi / p[2], p)
    problem = segment.add_periodicity(problem, autonomous=False)
    return segment, segment.add_ends(problem, "period", lambda first, last, T, p: T * p[2] - 2.0 * np.pi)


def fastest_start(n_intervals: int = 10) -> ExtremumProblem:
    """The largest velocity at t = 0 over k and phase; 'w' is held at one."""
    segment, problem = orbit(Mesh.uniform(n_intervals), np.array([2.0, 0.5, 1.0]))
    problem = segment.add_ends(problem, "velocity", lambda first, last, T, p: first[1], Role.MONITOR)
    problem = problem.add_parameters(("k", "phase", "w"), "orbit.p")
    return ExtremumProblem(
        problem=problem, objective="velocity", parameters=("k", "phase"), maximise=True, bounds={"k": (0.05, 10.0)}
    )


def amplitude(w: float) -> float:
    """Amplitude of the steady state for k = 1."""
    return float(1.0 / np.hypot(1.0 - w**2, w))


def _slope(w: float) -> float:
    """Derivative of the amplitude."""
    return (w - 2.0 * w**3) / ((1.0 - w**2) ** 2 + w**2) ** 1.5


def _difference_of_slopes(w: float) -> float:
    return _slope(w + DETUNING) - _slope(w)


def largest_difference() -> tuple[float, float]:
    """Frequency w below resonance and largest amplitude(w + 0.1) - amplitude(w), from the derivative's zero."""
    w, _ = brentq(_difference_of_slopes, 0.1, 0.5, xtol=1e-15, full_output=True)
    return float(w), amplitude(w + DETUNING) - amplitude(w)


def amplitude_difference(n_intervals: int = 10) -> ExtremumProblem:
    """The extremal difference of the amplitudes of two orbits, glued from two problems of one orbit each.

    The phase of each force is free and determined by x'(0) = 0, so that x(0) is the amplitude.
    """
    mesh, w = Mesh.uniform(n_intervals), 0.45
    problem = ZeroProblem()
    for name, frequency in (("slow", w), ("fast", w + DETUNING)):
        phase = float(np.angle(1.0 - frequency**2 + 1j * frequency))
        segment, single = orbit(mesh, np.array([1.0, phase, frequency]))
        single = segment.add_ends(single, "crest", lambda first, last, T, p: first[1])
        problem = problem.embed(name, single)
    return _glued(problem)


def _glued(problem: ZeroProblem) -> ExtremumProblem:
    """Conditions between the orbits: one stiffness, two frequencies a fixed distance apart."""
    slow, fast = problem.indices("slow.orbit.p"), problem.indices("fast.orbit.p")
    problem = problem.add_zero("same k", _difference, slow[:1], fast[:1])
    problem = problem.add_zero("detuning", _detuning, slow[2:], fast[2:])
    first = [problem.indices(f"{name}.orbit.x")[:1] for name in ("slow", "fast")]
    problem = problem.add_monitor("difference", _difference, *first)
    problem = problem.add_parameters(("k", "w"), slow[[0, 2]])
    return ExtremumProblem(problem=problem, objective="difference", parameters=("w",), maximise=True)


def _difference(a: ca.SX, b: ca.SX) -> ca.SX:
    return b - a


def _detuning(slow: ca.SX, fast: ca.SX) -> ca.SX:
    return fast - slow - DETUNING
