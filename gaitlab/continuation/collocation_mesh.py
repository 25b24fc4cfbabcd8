"""Piecewise polynomials on [0, 1]: base points, Gauss points, error estimate and adaption of the mesh."""

from dataclasses import dataclass
from functools import cached_property
from math import factorial

import numpy as np
from scipy.interpolate import BarycentricInterpolator

from ..errors import ProblemError


@dataclass(frozen=True, kw_only=True, eq=False)
class Mesh:
    """Intervals with continuous polynomials of one degree, collocated at as many Gauss-Legendre points."""

    knots: np.ndarray
    """Ends of the intervals, from 0 to 1, shape (N + 1,)."""
    degree: int = 4

    def __post_init__(self) -> None:
        increasing = self.knots.ndim == 1 and len(self.knots) >= 2 and bool(np.all(np.diff(self.knots) > 0.0))
        if not increasing or self.knots[0] != 0.0 or self.knots[-1] != 1.0 or self.degree < 1:
            raise ProblemError(f"a mesh needs knots that increase from 0 to 1 and a degree >= 1, got {self.knots}")

    @staticmethod
    def uniform(n_intervals: int, degree: int = 4) -> "Mesh":
        """Intervals of equal length."""
        return Mesh(knots=np.linspace(0.0, 1.0, n_intervals + 1), degree=degree)

    @property
    def n_intervals(self) -> int:
        """Number of intervals."""
        return len(self.knots) - 1

    @property
    def n_points(self) -> int:
        """Number of base points; those at knots are shared, which makes the polynomials continuous."""
        return self.n_intervals * self.degree + 1

    @cached_property
    def widths(self) -> np.ndarray:
        """Lengths of the intervals, shape (N,)."""
        return np.diff(self.knots)

    @cached_property
    def base(self) -> np.ndarray:
        """Base points within an interval of length 1, shape (degree + 1,)."""
        return np.linspace(0.0, 1.0, self.degree + 1)

    @cached_property
    def gauss(self) -> tuple[np.ndarray, np.ndarray]:
        """Gauss-Legendre points and weights within an interval of length 1, shapes (degree,)."""
        points, weights = np.polynomial.legendre.leggauss(self.degree)
        return (points + 1.0) / 2.0, weights / 2.0

    @cached_property
    def at_gauss(self) -> tuple[np.ndarray, np.ndarray]:
        """Matrices from values at the base points to values and slopes at the Gauss points, shape (m, m + 1)."""
        lagrange = [np.polynomial.Polynomial.fit(self.base, e, self.degree) for e in np.eye(self.degree + 1)]
        points = self.gauss[0]
        values, slopes = np.array([q(points) for q in lagrange]).T, np.array([q.deriv()(points) for q in lagrange]).T
        return values, slopes

    @cached_property
    def points(self) -> np.ndarray:
        """All base points, shape (n_points,)."""
        inside = self.knots[:-1, None] + self.widths[:, None] * self.base[:-1]
        return np.append(inside.ravel(), 1.0)

    @cached_property
    def members(self) -> np.ndarray:
        """Base points of each interval, shape (N, degree + 1)."""
        return self.degree * np.arange(self.n_intervals)[:, None] + np.arange(self.degree + 1)

    def evaluate(self, x: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Values at times t in [0, 1], shape (n_t,), of polynomials x, shape (n_points, n_x); result (n_t, n_x)."""
        interval = np.clip(np.searchsorted(self.knots, t, side="right") - 1, 0, self.n_intervals - 1)
        result = np.empty((len(t), x.shape[1]))
        for i in np.unique(interval):
            chosen = interval == i
            local = (t[chosen] - self.knots[i]) / self.widths[i]
            result[chosen] = BarycentricInterpolator(self.base, x[self.members[i]])(local)
        return result

    def transfer(self, x: np.ndarray, mesh: "Mesh") -> np.ndarray:
        """Polynomials x, shape (n_points, n_x), at the base points of another mesh."""
        return self.evaluate(x, mesh.points)

    def next_derivative(self, x: np.ndarray) -> np.ndarray:
        """Estimate of the derivative of order degree + 1 on each interval, shape (N, n_x), of x (n_points, n_x).

        The derivative of order `degree` is constant on an interval; its jumps over neighbouring ones (de Boor 1973)
        estimate the next.
        """
        steps = np.diff(x[self.members], n=self.degree, axis=1)[:, 0]
        highest = steps * (self.degree / self.widths[:, None]) ** self.degree
        jumps = np.diff(highest, axis=0) / ((self.widths[1:] + self.widths[:-1]) / 2.0)[:, None]
        if not len(jumps):
            return np.zeros_like(highest)
        return (np.vstack([jumps[:1], jumps]) + np.vstack([jumps, jumps[-1:]])) / 2.0

    def error(self, x: np.ndarray) -> float:
        """Estimated interpolation error of x, shape (n_points, n_x), relative to 1 + its largest value."""
        sigma = np.linspace(0.0, 1.0, 101)
        node_polynomial = np.max(np.abs(np.prod(sigma[:, None] - self.base, axis=1)))
        size = np.abs(self.next_derivative(x)) * self.widths[:, None] ** (self.degree + 1)
        constant = node_polynomial / factorial(self.degree + 1)
        return float(np.max(constant * size / (1.0 + np.abs(x).max(axis=0)), initial=0.0))

    def adapted(self, x: np.ndarray, n_intervals: int | None = None) -> "Mesh":
        """Mesh on which the estimated error of x, shape (n_points, n_x), is spread evenly (de Boor 1973)."""
        n = self.n_intervals if n_intervals is None else n_intervals
        scale = 1.0 + np.abs(x).max(axis=0)
        density = np.sum((np.abs(self.next_derivative(x)) / scale) ** (1.0 / (self.degree + 1)), axis=1)
        # A floor keeps intervals from growing without limit where the solution is straight.
        density = np.maximum(density, 0.1 * float(self.widths @ density)) + 1e-12
        mass = np.concatenate([[0.0], np.cumsum(density * self.widths)])
        knots = np.interp(np.linspace(0.0, mass[-1], n + 1), mass, self.knots)
        knots[0], knots[-1] = 0.0, 1.0
        return Mesh(knots=knots, degree=self.degree)
