"""The small quadratic subproblem of a search for weights."""

import numpy as np
from scipy.optimize import nnls


def damped_minimiser(
    theta: np.ndarray,
    residual: np.ndarray,
    jacobian: np.ndarray,
    damping: float,
    second_order: np.ndarray | None = None,
) -> np.ndarray:
    """Weights that minimise 1/2 |r + J (t - theta)|^2, damped as by Marquardt, on the simplex, shape (n_theta,).

    The damping counts relative to the diagonal of J'J; theta has shape (n_theta,), residual (n_r,), jacobian
    (n_r, n_theta), and `second_order` is what Gauss-Newton leaves out of the Hessian, shape (n_theta, n_theta).
    """
    hessian = jacobian.T @ jacobian
    scale = np.diag(np.diag(hessian) + 1e-12 * np.trace(hessian))
    hessian = hessian + damping * scale + (0.0 if second_order is None else second_order)
    return simplex_minimiser(theta, jacobian.T @ residual, hessian)


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
