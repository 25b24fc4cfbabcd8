"""Where the unknowns and constraints of a collocated mechanical problem lie, for one sequence of contacts."""

from dataclasses import dataclass

import numpy as np

from ..errors import ProblemError
from ..ocp.mechanical import ContactStage


@dataclass(frozen=True)
class Boundary:
    """Which entries of the states x = (q, v) are given: pairs (node, indices)."""

    given: tuple[tuple[int, tuple[int, ...]], ...] = ()

    def indices(self, node: int) -> set[int]:
        """Given entries of the state at a node."""
        return {i for n, entries in self.given if n == node for i in entries}


@dataclass(frozen=True, kw_only=True, order=True)
class ContactRow:
    """One scalar condition y(x_node) - y(x_minus_node) = 0 or y(x_node) >= 0, y a contact position or velocity."""

    component: int
    """Index into (positions, velocities)."""
    node: int
    minus_node: int = -1
    """Node whose value is subtracted, -1 for none."""


@dataclass(frozen=True)
class MechanicalLayout:
    """Index tables. Unknowns w = (x_0 ... x_N, then per interval and Gauss point the active forces)."""

    stages: tuple[ContactStage, ...]
    n_q: int
    n_f: int
    n_r: int
    boundary: Boundary
    limited: tuple[int, ...] = ()
    """Coordinates q_i with limits at the nodes where they are not given."""
    redundant: frozenset[ContactRow] = frozenset()
    """Contact conditions that follow from the others and are left out (see `contact_rank`)."""
    touching_end: tuple[int, ...] = ()
    """Contact coordinates that are zero at the last node (heights of points that land there)."""

    def __post_init__(self) -> None:
        if not self.stages:
            raise ProblemError("a problem needs at least one stage, got none")

    @property
    def n_intervals(self) -> int:
        """Number of intervals N over all stages."""
        return sum(s.n_intervals for s in self.stages)

    def stage_of_interval(self) -> np.ndarray:
        """Stage index of each interval, shape (N,)."""
        return np.repeat(np.arange(len(self.stages)), [s.n_intervals for s in self.stages])

    def interval_lengths(self) -> np.ndarray:
        """Length of each interval [s], shape (N,)."""
        return np.concatenate([np.full(s.n_intervals, s.duration / s.n_intervals) for s in self.stages])

    def node_times(self) -> np.ndarray:
        """Times of the nodes [s], shape (N + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.interval_lengths())])

    def force_index(self) -> np.ndarray:
        """Index in w of each force, -1 where inactive, shape (N, 2, n_f)."""
        table = np.full((self.n_intervals, 2, self.n_f), -1, dtype=np.int64)
        active = np.zeros_like(table, dtype=bool)
        for k, stage in enumerate(self.stage_of_interval()):
            active[k][:, list(self.stages[stage].active)] = True
        table[active] = 2 * self.n_q * (self.n_intervals + 1) + np.arange(active.sum())
        return table

    def point_index(self) -> np.ndarray:
        """Index in w of (q0, v0, q1, v1, f) of each Gauss point, shape (N, 2, 4 n_q + n_f); -1 where inactive."""
        n, width = self.n_intervals, 4 * self.n_q
        x = 2 * self.n_q * np.arange(n)[:, None] + np.arange(width)  # (N, 4 n_q): neighbouring nodes are adjacent
        return np.concatenate([np.repeat(x[:, None], 2, axis=1), self.force_index()], axis=2)

    def _q_given(self, node: int) -> bool:
        return set(range(self.n_q)) <= self.boundary.indices(node)

    def _v_given(self, node: int) -> bool:
        return set(range(self.n_q, 2 * self.n_q)) <= self.boundary.indices(node)

    def contact_equalities(self) -> list[ContactRow]:
        """Conditions that hold points in contact in place, and those that make landings soft."""
        rows: list[ContactRow] = []
        node = 0
        for stage in self.stages:
            if not self._q_given(node):
                rows += [ContactRow(component=i, node=node) for i in stage.grounded]
            if not self._v_given(node):
                rows += [ContactRow(component=self.n_f + i, node=node) for i in stage.landing]
            for k in range(node, node + stage.n_intervals):
                rows += [ContactRow(component=i, node=k + 1, minus_node=k) for i in stage.active]
                if not self._v_given(k + 1):
                    rows += [ContactRow(component=self.n_f + i, node=k + 1) for i in stage.active]
            node += stage.n_intervals
        if not self._q_given(node):
            rows += [ContactRow(component=i, node=node) for i in self.touching_end]
        return [row for row in rows if row not in self.redundant]

    def clearances(self) -> list[ContactRow]:
        """Heights that must not be negative, at the nodes where they are free."""
        rows: list[ContactRow] = []
        node = 0
        for index, stage in enumerate(self.stages):
            end = node + stage.n_intervals
            lands = set(self.stages[index + 1].grounded if index + 1 < len(self.stages) else self.touching_end)
            for k in range(node + 1, end + 1):
                free = [i for i in stage.clear if not (k == end and i in lands) and not self._q_given(k)]
                rows += [ContactRow(component=i, node=k) for i in free]
            node = end
        return rows

    def limit_columns(self) -> np.ndarray:
        """Indices in w of the coordinates with limits, shape (n,), node by node."""
        width = 2 * self.n_q
        free = [(k, i) for k in range(self.n_intervals + 1) for i in self.limited if i not in self.boundary.indices(k)]
        return np.array([width * k + i for k, i in free], dtype=np.int64)

    def cone_rows(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Force inequalities as (row, index in w, coefficient) triplets, each of shape (nnz,)."""
        index, stage_of = self.force_index(), self.stage_of_interval()
        rows: list[np.ndarray] = []
        columns: list[np.ndarray] = []
        values: list[np.ndarray] = []
        count = 0
        for k, j in np.ndindex(self.n_intervals, 2):
            cone = self.stages[stage_of[k]].force_cone
            r, i = np.nonzero(cone)
            rows.append(count + r)
            columns.append(index[k, j, i])
            values.append(cone[r, i])
            count += len(cone)
        return np.concatenate(rows), np.concatenate(columns), np.concatenate(values)
