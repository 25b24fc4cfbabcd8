"""Where the search for the weights of a gait starts: from the measurements alone."""

import numpy as np

from ..bilevel.simplex_step import damped_minimiser
from .point_foot_gait import GaitLevel, GaitOptimum

DAMPING = 1e-3
"""Of the first step, relative to the diagonal of J'J."""


def first_estimate(level: GaitLevel, theta: np.ndarray) -> tuple[np.ndarray, GaitOptimum]:
    """Weights near the best ones, and the optimal gait for them, from any start weights; both (n_theta,).

    The measurements are tracked less and less closely. Where the criteria just begin to show, one Gauss-Newton step
    on the misfit tells the weights: the optimal gait for weights far from them, which may be hard to find, is not
    needed.
    """
    tracked = level.track(theta)
    found = damped_minimiser(theta, tracked.residual, tracked.jacobian(), DAMPING)
    return found, level.follow(found, 0.0, tracked)
