"""The small quadratic subproblem of a search for weights."""

import numpy as np
from scipy.optimize import nnls


def simplex_minimiser(theta: np.ndarray, gradient: np.ndarray, hessian: np.ndarray) -> np.ndarray:
    """Weights t >= 0 with sum 1 that minimise g'(t - theta) + 1/2 (t - theta)' H (t - theta), shape (n_theta,).

    Solved as nonnegative least squares (Lawson and Hanson 1974, ch. 23). Directions in which the Hessian, shape
    (n_theta, n_theta), is not positive get a small positive curvature; theta and gradient have shape (n_theta,).
    """
    values, vectors = np.linalg.eigh(hessian)
    # A least-squares form needs a positive definite model.
    values = np.maximum(values, 1e-10 * values[-1])
    root = np.sqrt(values)[:, None] * vectors.T
    anchor = 1e4 * float(root.max())
    b = root @ theta - (vectors.T @ gradient) / np.sqrt(values)
    t, _ = nnls(np.vstack([root, np.full((1, len(theta)), anchor)]), np.append(b, anchor))
    return t / t.sum()
