"""A walk cut at the nodes where its whole state is given.

Between two such nodes the optimal motion depends on nothing outside: the problem falls apart into arcs that share only
the weights. Each is solved with step lengths and regularisations of its own, so that one stubborn arc does not hold up
the others; the joint solution is certified on the whole problem.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import count
from uuid import uuid4

import numpy as np

from ..multibody.dynamics import ModelLayout
from ..nlp.interior_point import InteriorPoint
from ..nlp.sparse_solution import SparseSolution, Status, certify
from ..nlp.workers import Workers
from ..ocp.mechanical import ContactStage
from ..transcription.mechanical_layout import Boundary, ContactRow, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure
from .model import walking_functions


@dataclass(frozen=True, eq=False)
class Arc:
    """One part of a layout and where its unknowns and constraints lie in the whole."""

    structure: MechanicalStructure
    nodes: slice
    """Its nodes in the whole."""
    w: np.ndarray
    """Places of its variables in the whole, shape (n_w,)."""
    g: np.ndarray
    """Places of its equality constraints, shape (n_g,)."""
    c: np.ndarray
    """Places of its inequality constraints, shape (n_c,)."""

    def data(self, whole: MechanicalData) -> MechanicalData:
        """The arc's part of the data of a problem."""
        nodes = self.nodes
        tracking = whole.tracking[nodes].copy()
        if nodes.stop < len(whole.tracking):
            tracking[-1] = 0.0  # The next arc begins there and has it.
        return replace(whole, reference=whole.reference[nodes], tracking=tracking, given=whole.given[nodes])

    def part(self, x: SparseSolution) -> SparseSolution:
        """The arc's part of a solution."""
        return replace(x, w=x.w[self.w], s=x.s[self.c], lam_g=x.lam_g[self.g], lam_c=x.lam_c[self.c])


@dataclass(frozen=True, eq=False, kw_only=True)
class ArcTask:
    """One arc to solve, here or in another process."""

    key: str
    """Same for all tasks with this layout."""
    model: ModelLayout
    layout: MechanicalLayout
    data: MechanicalData
    start: SparseSolution | np.ndarray
    """Solution, or variables of shape (n_w,)."""
    methods: tuple[InteriorPoint, ...]

    def run(self) -> SparseSolution:
        """Solution of the first method that solves it, else of the last."""
        return solve_in_turn(MechanicalProblem(self._structure(), self.data), self.start, self.methods)

    def _structure(self) -> MechanicalStructure:
        if self.key not in _structures:
            while len(_structures) >= MOST_STRUCTURES:
                del _structures[next(iter(_structures))]
            _structures[self.key] = MechanicalStructure(self.layout, walking_functions(self.model).functions)
        return _structures[self.key]


def solve_in_turn(
    problem: MechanicalProblem, start: SparseSolution | np.ndarray, methods: Sequence[InteriorPoint]
) -> SparseSolution:
    """Solution of the first method that solves a problem from a start, variables (n_w,), else of the last."""
    found = methods[0].solve(problem, start)
    for method in methods[1:]:
        if found.status is Status.SOLVED:
            break
        found = method.solve(problem, start)
    return found


COST_NOISE = 1e-6
"""Costs that differ by less, relatively, are the same: the barrier parameter alone makes such a difference."""
MOST_STRUCTURES = 64
_structures: dict[str, MechanicalStructure] = {}
"""Index tables of the arcs that this process has solved; making them takes longer than an iteration."""


@dataclass(frozen=True, eq=False)
class Arcs:
    """All arcs of a structure whose boundary gives whole states at some nodes, the first and the last among them."""

    whole: MechanicalStructure
    model: ModelLayout
    key: str = field(default_factory=lambda: uuid4().hex)

    @cached_property
    def parts(self) -> tuple[Arc, ...]:
        """The arcs in the order of time."""
        layout = self.whole.layout
        width = 2 * layout.n_q
        cuts = [node for node, entries in layout.boundary.given if len(entries) == width]
        return tuple(self._arc(a, b) for a, b in zip(cuts[:-1], cuts[1:], strict=True))

    def solve(
        self,
        problem: MechanicalProblem,
        start: SparseSolution | np.ndarray,
        methods: Sequence[InteriorPoint],
        workers: Workers | None = None,
        done: Callable[[int], None] | None = None,
    ) -> SparseSolution:
        """Solve a problem of this structure arc by arc, from a point (n_w,) or an earlier solution.

        Each arc is given to the methods in turn until one solves it. `done(n_arcs_solved)` may raise to cancel.
        Iterations are those of the slowest arc; the status is the first that is not "solved".
        """
        tasks = [
            ArcTask(
                key=f"{self.key}-{i}",
                model=self.model,
                layout=arc.structure.layout,
                data=arc.data(problem.data),
                start=start[arc.w] if isinstance(start, np.ndarray) else arc.part(start),
                methods=tuple(methods),
            )
            for i, arc in enumerate(self.parts)
        ]
        finished = count(1)

        def tell(_index: int, _found: SparseSolution) -> None:
            if done is not None:
                done(next(finished))

        if workers is not None:
            return self._joined(problem, workers.map(tasks, tell))
        found: list[SparseSolution] = []
        for task in tasks:
            found.append(task.run())
            tell(len(found), found[-1])
        return self._joined(problem, found)

    def lowest(self, problem: MechanicalProblem, first: SparseSolution, second: SparseSolution) -> SparseSolution:
        """Of two solutions the better one in each arc; the first where the costs agree but for rounding."""
        found: list[SparseSolution] = []
        for arc in self.parts:
            part = MechanicalProblem(arc.structure, arc.data(problem.data))
            pair = [replace(arc.part(x), f=part.values(x.w[arc.w]).f) for x in (first, second)]
            found.append(pair[1] if pair[1].f < pair[0].f - COST_NOISE * abs(pair[0].f) else pair[0])
        return self._joined(problem, found)

    def _joined(self, problem: MechanicalProblem, found: list[SparseSolution]) -> SparseSolution:
        sizes = problem.structure
        w, s = np.zeros(sizes.n_w), np.zeros(sizes.n_c)
        lam_g, lam_c = np.zeros(sizes.n_g), np.zeros(sizes.n_c)
        for arc, x in zip(self.parts, found, strict=True):
            w[arc.w], s[arc.c], lam_c[arc.c] = x.w, x.s, x.lam_c
            # The state between two arcs is given once in the whole and once in each of them: multipliers add up.
            lam_g[arc.g] += x.lam_g
        status = next((x.status for x in found if x.status is not Status.SOLVED), Status.SOLVED)
        joint = replace(found[0], w=w, s=s, lam_g=lam_g, lam_c=lam_c)
        iterations = max(x.iterations for x in found)
        return certify(problem, joint, mu=max(x.mu for x in found), iterations=iterations, status=status)

    def _arc(self, first: int, last: int) -> Arc:
        whole = self.whole.layout
        every = tuple(range(2 * whole.n_q))
        inside = [(n - first, entries) for n, entries in whole.boundary.given if first < n < last]
        layout = MechanicalLayout(
            part_of_stages(whole.stages, first, last),
            whole.n_q,
            whole.n_f,
            whole.n_r,
            Boundary(((0, every), *inside, (last - first, every))),
            whole.limited,
            frozenset(_moved(row, -first) for row in whole.redundant),
        )
        structure = MechanicalStructure(layout, self.whole.functions)
        return Arc(
            structure=structure,
            nodes=slice(first, last + 1),
            w=self._variables(structure, first, last),
            g=self._equalities(structure, first, last),
            c=self._inequalities(structure, first),
        )

    def _variables(self, part: MechanicalStructure, first: int, last: int) -> np.ndarray:
        width = 2 * part.layout.n_q
        places = np.empty(part.n_w, dtype=np.int64)
        places[: width * (last - first + 1)] = np.arange(width * first, width * (last + 1))
        used = part.force_index >= 0
        places[part.force_index[used]] = self.whole.force_index[2 * first : 2 * last][used]
        return places

    def _equalities(self, part: MechanicalStructure, first: int, last: int) -> np.ndarray:
        n_r, width = part.layout.n_r, 2 * part.layout.n_q
        n_residual = 2 * n_r * self.whole.layout.n_intervals
        contact = {row: n_residual + i for i, row in enumerate(self.whole.contact)}
        given = {int(c): n_residual + len(contact) + i for i, c in enumerate(self.whole.fixed_columns)}
        rows = [contact[_moved(row, first)] for row in part.contact]
        fixed = [given[int(column) + width * first] for column in part.fixed_columns]
        return np.concatenate([np.arange(2 * n_r * first, 2 * n_r * last), np.array(rows + fixed, dtype=np.int64)])

    def _inequalities(self, part: MechanicalStructure, first: int) -> np.ndarray:
        whole, width = self.whole, 2 * part.layout.n_q
        cones_before = _cone_rows(whole.layout, first)
        clear = {row: whole.n_cone + i for i, row in enumerate(whole.clear)}
        first_limit = whole.n_cone + len(whole.clear)
        limit = {int(column): first_limit + i for i, column in enumerate(whole.limits)}
        rows = [clear[_moved(row, first)] for row in part.clear]
        lower = [limit[int(column) + width * first] for column in part.limits]
        upper = [place + len(whole.limits) for place in lower]
        return np.concatenate(
            [np.arange(cones_before, cones_before + part.n_cone), np.array(rows + lower + upper, dtype=np.int64)]
        )


def part_of_stages(stages: tuple[ContactStage, ...], first: int, last: int) -> tuple[ContactStage, ...]:
    """The stages between two nodes."""
    parts: list[ContactStage] = []
    node = 0
    for stage in stages:
        n = min(last, node + stage.n_intervals) - max(first, node)
        if n > 0:
            parts.append(replace(stage, n_intervals=int(n), duration=stage.duration * n / stage.n_intervals))
        node += stage.n_intervals
    return tuple(parts)


def _cone_rows(layout: MechanicalLayout, intervals: int) -> int:
    """Number of force inequalities before an interval."""
    return 2 * sum(len(layout.stages[i].force_cone) for i in layout.stage_of_interval()[:intervals])


def _moved(row: ContactRow, nodes: int) -> ContactRow:
    return replace(row, node=row.node + nodes, minus_node=row.minus_node + nodes if row.minus_node >= 0 else -1)
