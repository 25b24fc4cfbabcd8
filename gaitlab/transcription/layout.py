"""Where states, controls and control values stand among the unknowns."""

from dataclasses import dataclass

import numpy as np

from ..ocp.problem import MultiStageProblem
from ..ocp.stage import Stage
from ..ocp.symbols import element_names
from .control_shapes import ControlShape
from .grid import Grid
from .schemes import Scheme


@dataclass(frozen=True, kw_only=True, eq=False)
class StageLayout:
    """Places of one stage's unknowns in w, ordered along time so that derivatives are banded."""

    grid: Grid
    x: np.ndarray
    """States at nodes, shape (N + 1, n_x)."""
    c: np.ndarray
    """Control coefficients at nodes, column by column, shape (N or N + 1, n_u * per_node)."""
    inside: np.ndarray
    """States inside intervals, point by point, shape (N, n_inside * n_x)."""
    joined: bool
    """Whether an interval uses the control coefficients of its right node."""

    def interval(self, q: np.ndarray) -> np.ndarray:
        """Unknowns (x, c, inside, x right, c right if joined, q) of all intervals; q has shape (n_q,)."""
        n = self.grid.n
        parts = [self.x[:n], self.c[:n], self.inside, self.x[1:]]
        parts += [self.c[1:]] if self.joined else []
        return np.hstack([*parts, np.tile(q, (n, 1))])


@dataclass(frozen=True, kw_only=True, eq=False)
class Layout:
    """Places of all unknowns in w."""

    n_w: int
    q: np.ndarray
    """Control values, shape (n_q,)."""
    stages: tuple[StageLayout, ...]
    names: tuple[str, ...]
    """Names of all unknowns, for messages."""


def lay_out(problem: MultiStageProblem, grids: tuple[Grid, ...], scheme: Scheme, shape: ControlShape) -> Layout:
    """Order the unknowns: q, then stage by stage and node by node (x, c, inside)."""
    names = element_names(problem.q)
    q, stages = np.arange(len(names)), list[StageLayout]()
    for stage, grid in zip(problem.stages, grids, strict=True):
        places = _Places(stage, scheme, shape, names)
        for k in range(grid.n + 1):
            places.add_node(k, last=k == grid.n)
        stages.append(places.layout(grid))
    return Layout(n_w=len(names), q=q, stages=tuple(stages), names=tuple(names))


class _Places:
    def __init__(self, stage: Stage, scheme: Scheme, shape: ControlShape, names: list[str]) -> None:
        self.stage, self.scheme, self.shape, self.names = stage, scheme, shape, names
        self.x, self.c, self.inside = list[np.ndarray](), list[np.ndarray](), list[np.ndarray]()

    def add_node(self, k: int, last: bool) -> None:
        where = f"of stage '{self.stage.name}'"
        states, controls = element_names(self.stage.x), element_names(self.stage.u)
        self.x.append(self._take([f"{name} at node {k} {where}" for name in states]))
        if not last or self.shape.joined:
            kinds = ["", "slope of "][: self.shape.per_node]
            self.c.append(self._take([f"{kind}{name} at node {k} {where}" for kind in kinds for name in controls]))
        if not last:
            points = range(self.scheme.n_inside)
            self.inside.append(
                self._take([f"{n} at point {j} of interval {k} {where}" for j in points for n in states])
            )

    def _take(self, names: list[str]) -> np.ndarray:
        first = len(self.names)
        self.names.extend(names)
        return np.arange(first, len(self.names))

    def layout(self, grid: Grid) -> StageLayout:
        return StageLayout(
            grid=grid, x=np.array(self.x), c=np.array(self.c), inside=np.array(self.inside), joined=self.shape.joined
        )
