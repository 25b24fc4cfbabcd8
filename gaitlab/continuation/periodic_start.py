"""Where families of periodic orbits begin: Hopf points of equilibria."""

from dataclasses import dataclass
from itertools import combinations

import casadi as ca
import numpy as np

from ..errors import ProblemError
from .collocation_mesh import Mesh
from .collocation_problem import Field


@dataclass(frozen=True, kw_only=True)
class SmallOrbit:
    """First-order approximation of a periodic orbit close to a Hopf point."""

    x: np.ndarray
    """States at the base points, shape (n_points, n_x)."""
    shape: np.ndarray
    """Difference to the equilibrium per unit of amplitude, shape (n_points, n_x)."""
    duration: float
    """Period, from the imaginary part of the critical eigenvalues."""


def field_jacobian(field: Field, x: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Derivative of an autonomous field in the state at x, shape (n_x,), and p, shape (n_p,); result (n_x, n_x)."""
    x_symbol, p_symbol = ca.SX.sym("x", len(x)), ca.SX.sym("p", len(p))
    f = ca.SX(field(ca.SX(0), x_symbol, p_symbol))
    return np.asarray(ca.Function("f_x", [x_symbol, p_symbol], [ca.densify(ca.jacobian(f, x_symbol))])(x, p))


def hopf_test(jacobian: np.ndarray) -> float:
    """Product of all sums of two eigenvalues of a matrix, shape (n_x, n_x): zero at a Hopf point.

    It vanishes at neutral saddles (two real eigenvalues of opposite sign) too (Kuznetsov, Elements of Applied
    Bifurcation Theory, sec. 10.2.2).
    """
    sums = [a + b for a, b in combinations(np.linalg.eigvals(jacobian), 2)]
    return float(np.real(np.prod(sums)))


def small_orbit(jacobian: np.ndarray, equilibrium: np.ndarray, amplitude: float, mesh: Mesh) -> SmallOrbit:
    """Orbit around an equilibrium, shape (n_x,), whose Jacobian, shape (n_x, n_x), has imaginary eigenvalues.

    Raises `ProblemError` where no eigenvalue is close to the imaginary axis.
    """
    values, vectors = np.linalg.eig(jacobian)
    oscillating = np.flatnonzero(values.imag > 1e-8 * np.abs(values).max())
    if not len(oscillating):
        raise ProblemError(f"the equilibrium does not oscillate: its eigenvalues are {values}")
    i = oscillating[np.argmin(np.abs(values[oscillating].real))]
    if abs(values[i].real) > 1e-3 * abs(values[i].imag):
        raise ProblemError(f"the equilibrium is no Hopf point: its eigenvalues are {values}")
    shape = np.real(np.exp(2j * np.pi * mesh.points)[:, None] * vectors[:, i] / np.linalg.norm(vectors[:, i]))
    return SmallOrbit(x=equilibrium + amplitude * shape, shape=shape, duration=2.0 * np.pi / float(values[i].imag))
