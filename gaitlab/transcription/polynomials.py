"""Interpolation on [0, 1] through collocation points."""

import numpy as np

from ..errors import ProblemError


def radau_points(n: int) -> np.ndarray:
    """Right Radau points in (0, 1], the last is 1, shape (n,): zeros of P_n - P_(n-1) on [-1, 1], shifted."""
    _require_degree(n)
    series = np.zeros(n + 1)
    series[n - 1 :] = [-1.0, 1.0]
    roots = np.sort(np.polynomial.legendre.legroots(series).real)
    points = 0.5 * (1.0 + roots)
    points[-1] = 1.0
    return points


def legendre_points(n: int) -> np.ndarray:
    """Gauss-Legendre points in (0, 1), shape (n,)."""
    _require_degree(n)
    return 0.5 * (1.0 + np.polynomial.legendre.leggauss(n)[0])


def lagrange_values(points: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Lagrange polynomials through points, shape (n,), at s, shape (m,); result (m, n)."""
    return np.column_stack([polynomial(s) for polynomial in _lagrange(points)])


def lagrange_slopes(points: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Their derivatives at s, shape (m,); result (m, n)."""
    return np.column_stack([polynomial.deriv()(s) for polynomial in _lagrange(points)])


def lagrange_integrals(points: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Their integrals from 0 to s, shape (m,); result (m, n)."""
    return np.column_stack([polynomial.integ()(s) for polynomial in _lagrange(points)])


def lagrange_coefficients(points: np.ndarray) -> np.ndarray:
    """Coefficients by rising powers, one polynomial per row, shape (n, n)."""
    return np.vstack([polynomial.convert(domain=[-1, 1]).coef for polynomial in _lagrange(points)])


def _lagrange(points: np.ndarray) -> list[np.polynomial.Polynomial]:
    polynomials = list[np.polynomial.Polynomial]()
    for i, point in enumerate(points):
        others = np.delete(points, i)
        monic = np.polynomial.Polynomial.fromroots(others) if others.size else np.polynomial.Polynomial([1.0])
        polynomials.append(monic / np.prod(point - others))
    return polynomials


def _require_degree(n: int) -> None:
    if not 1 <= n <= 12:
        raise ProblemError(f"collocation needs 1 to 12 points, got {n}")
