"""First guess of a gait whose states are given at the ends of its stages, from noisy measurements."""

from collections.abc import Sequence

import numpy as np


def smooth_states(
    given: np.ndarray, durations: Sequence[float], measured: Sequence[np.ndarray]
) -> tuple[np.ndarray, ...]:
    """Smooth states between the given ones, near the measurements, per stage, shapes (N_k + 1, 2 n_q).

    The cubic through the given states plus s^2 (1 - s)^2 times a polynomial in s, fitted to the measurements.

    Args:
        given: States at both ends of each stage [m, rad, 1/s], shape (n_stages, 2, 2 n_q).
        durations: Of the stages [s].
        measured: Coordinates at the nodes of each stage [m, rad], shapes (N_k + 1, n_q).
    """
    found, n_q = list[np.ndarray](), given.shape[2] // 2
    for duration, q, ends in zip(durations, measured, given, strict=True):
        n = len(q) - 1
        s = np.linspace(0.0, 1.0, n + 1)
        (q0, v0), (q1, v1) = ends[0].reshape(2, n_q), ends[1].reshape(2, n_q)
        cubic = np.polynomial.Polynomial
        hermite = [cubic([1, 0, -3, 2]), cubic([0, 1, -2, 1]), cubic([0, 0, 3, -2]), cubic([0, 0, -1, 1])]
        bubble = [cubic([0, 0, 1, -2, 1]) * cubic.basis(i) for i in range(min(6, max(2, n // 4)))]
        known = np.stack([q0, duration * v0, q1, duration * v1])
        fixed = np.stack([h(s) for h in hermite], axis=1) @ known
        table = np.stack([b(s) for b in bubble], axis=1)
        coefficients = np.linalg.lstsq(table[1:-1], (q - fixed)[1:-1], rcond=None)[0]
        rates = np.stack([h.deriv()(s) for h in hermite], axis=1) @ known
        rates += np.stack([b.deriv()(s) for b in bubble], axis=1) @ coefficients
        found.append(np.hstack([fixed + table @ coefficients, rates / duration]))
    return tuple(found)
