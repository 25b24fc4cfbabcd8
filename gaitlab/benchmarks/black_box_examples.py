r"""The four numerical examples of Sovukluk and Ott (2025), section 4, for black-box optimisation.

The printed optimum of the arm, (1.647, 3.141, -1.647), has a mirror image with the same cost, (-1.647, 3.142, 1.647),
and there is a local minimum at (pi/3, 2 pi/3, pi/3) of nearly five times the cost: which one is found from the printed
start depends on the lengths of the first steps.
"""

from dataclasses import dataclass

import numpy as np

from ..nlp.null_space.problem import BlackBoxProblem

GRAVITY = 9.81
"""[m/s^2]; the source leaves g open, which scales the arm's cost only."""


@dataclass(frozen=True, kw_only=True)
class BlackBoxExample:
    """A problem with what the source prints about it."""

    name: str
    problem: BlackBoxProblem
    x0: np.ndarray
    """Start of the source, shape (n,)."""
    optima: np.ndarray
    """The printed optimum, to more digits where another source has them, and its mirror images, shape (n_o, n)."""
    published_iterations: int
    published_seconds: float

    def error(self, x: np.ndarray) -> float:
        """Largest distance of an entry of x, shape (n,), from the nearest optimum."""
        return float(np.min(np.max(np.abs(self.optima - x), axis=1)))


def black_box_examples() -> tuple[BlackBoxExample, ...]:
    """Examples 4.1 to 4.4."""
    return (_convex(), _rosenbrock(), _hock_schittkowski_71(), _arm())


def arm_torques(x: np.ndarray) -> np.ndarray:
    """Static torques of the three-link arm with joint angles x [rad], shape (3,)."""
    first, second, third = np.cos(np.cumsum(x))
    return GRAVITY * np.array([2.5 * first + 1.5 * second + 0.5 * third, 1.5 * second + 0.5 * third, 0.5 * third])


def _example(
    name: str, problem: BlackBoxProblem, x0: list[float], optima: list[list[float]], published: tuple[int, float]
) -> BlackBoxExample:
    return BlackBoxExample(
        name=name,
        problem=problem,
        x0=np.array(x0),
        optima=np.array(optima),
        published_iterations=published[0],
        published_seconds=published[1],
    )


def _convex() -> BlackBoxExample:
    problem = BlackBoxProblem(
        cost=lambda x: float(np.sum((x - np.arange(1.0, 6.0)) ** 2)),
        equality=lambda x: np.array([x[0] + 5.0, x[1] - 5.0]),
        inequality=lambda x: np.array([x[2] + 3.0, x[3] - 3.0]),
    )
    return _example("4.1 convex", problem, [0.0] * 5, [[-5.0, 5.0, -3.0, 3.0, 5.0]], (6, 8e-6))


def _rosenbrock() -> BlackBoxExample:
    problem = BlackBoxProblem(
        cost=lambda x: float(100.0 * (x[1] - x[0] ** 2) ** 2 + (1.0 - x[0]) ** 2),
        inequality=lambda x: np.array([x @ x - 1.0]),
    )
    return _example("4.2 Rosenbrock", problem, [0.0, 0.0], [[0.7864, 0.6177]], (201, 35e-6))


def _hock_schittkowski_71() -> BlackBoxExample:
    # The optimum to more digits: Hock and Schittkowski, Test Examples for Nonlinear Programming Codes, 1981.
    problem = BlackBoxProblem(
        cost=lambda x: float(x[0] * x[3] * np.sum(x[:3]) + x[2]),
        equality=lambda x: np.array([x @ x - 40.0]),
        inequality=lambda x: np.concatenate([[25.0 - np.prod(x)], 1.0 - x, x - 5.0]),
    )
    return _example("4.3 HS071", problem, [1.0, 5.0, 5.0, 1.0], [[1.0, 4.7429996, 3.8211503, 1.3794082]], (100, 139e-6))


def _arm() -> BlackBoxExample:
    problem = BlackBoxProblem(
        cost=lambda x: float(arm_torques(x) @ arm_torques(x)),
        equality=lambda x: np.array([np.cos(np.cumsum(x)).sum() + 1.0, np.sin(np.cumsum(x)).sum()]),
        equality_names=("p_x = -1", "p_y = 0"),
    )
    return _example("4.4 arm", problem, [np.pi / 4] * 3, [[1.647, 3.141, -1.647], [-1.647, 3.142, 1.647]], (8, 42e-6))
