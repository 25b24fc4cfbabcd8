"""A start that satisfies all inequalities, found by following the solutions that violate them.

The barrier form of complementarity (`inequality`) needs a strictly feasible start; a path through an infeasible one
that enters the feasible set supplies it (Li and Dankowicz 2020 relax the violated inequalities instead).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .extended_system import ExtendedSystem
from .path_events import TestFunction
from .path_following import Path, PathFollowing, tangent_at
from .staged_function import Role
from .zero_problem import ZeroProblem

MARGIN = 0.1
"""How far inside the start lies, as a share of the worst violation."""


@dataclass(frozen=True, kw_only=True)
class FeasibleStart:
    """The problem at a feasible start, or as it was where none was found."""

    problem: ZeroProblem
    found: bool
    reason: str


def feasible_start(
    method: PathFollowing,
    problem: ZeroProblem,
    fixed: Mapping[str, float],
    bounds: Mapping[str, tuple[float, float]],
) -> FeasibleStart:
    """Follow the solutions with some monitors fixed until every inequality holds with a margin."""
    name, worst = worst_inequality(problem, problem.start)
    if worst < 0.0:
        return FeasibleStart(problem=problem, found=True, reason="the start is feasible")
    system = ExtendedSystem(problem=problem, fixed=fixed)
    inside = -MARGIN * max(worst, 1e-2)
    event = TestFunction(name="feasible", function=lambda u: worst_inequality(problem, u)[1] - inside, stops=True)
    x = problem.start
    tangent = tangent_at(system, x, np.random.default_rng(0).normal(size=len(x)))
    if tangent is None:
        reason = "the start lies on no single path: its Jacobian has no full rank"
        return FeasibleStart(problem=problem, found=False, reason=reason)
    rising = _slope(problem, name, tangent) > 0.0
    paths: list[Path] = []
    for sign in (-1.0, 1.0) if rising else (1.0, -1.0):
        path = method.follow(system, x, direction=sign * tangent, events=(event,), bounds=dict(bounds))
        if path.events:
            moved = problem.starting_at(path.events[-1].x).refreshed(path.events[-1].x)
            return FeasibleStart(problem=moved, found=True, reason="a feasible start was found")
        paths.append(path)
    reasons = "; the other way: ".join(path.reason for path in paths)
    reason = f"the start violates the inequality '{name}' by {worst:.3g}, and so does its path: {reasons}"
    return FeasibleStart(problem=problem, found=False, reason=reason)


def worst_inequality(problem: ZeroProblem, u: np.ndarray) -> tuple[str, float]:
    """Name and value of the largest inequality at u, shape (n_u,); minus infinity where there is none."""
    values = {name: float(problem.stage(name).values(u)[0]) for name in problem.names_of(Role.INEQUALITY)}
    return max(values.items(), key=lambda item: item[1], default=("", -np.inf))


def _slope(problem: ZeroProblem, name: str, tangent: np.ndarray) -> float:
    entries = problem.stage(name).jacobian(problem.start)
    return float(entries.values @ tangent[entries.cols])
