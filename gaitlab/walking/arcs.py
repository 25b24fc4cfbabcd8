"""A walk cut at the nodes where its whole state is given.

Between two such nodes the optimal motion depends on nothing outside: the problem falls apart into arcs that share only
the weights. Each is solved with step lengths and regularisations of its own, so that one stubborn arc does not hold up
the others; the joint solution is certified on the whole problem.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import count
from typing import NamedTuple
from uuid import uuid4

import numpy as np

from ..multibody.dynamics import ModelLayout
from ..nlp.interior_point import InteriorPoint
from ..nlp.sparse_problem import multiply_transposed
from ..nlp.sparse_solution import SparseSolution, Status, certify
from ..nlp.workers import Workers
from ..ocp.mechanical import ContactStage
from ..transcription.mechanical_layout import Boundary, ContactRow, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure
from .model import walking_functions


class Attempt(NamedTuple):
    """A method and where it starts."""

    method: InteriorPoint
    start: SparseSolution | np.ndarray
    """Solution, or variables of shape (n_w,)."""


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

    def attempt(self, whole: Attempt) -> Attempt:
        """The arc's part of an attempt."""
        x = whole.start
        if isinstance(x, np.ndarray):
            return whole._replace(start=x[self.w])
        own = replace(x, w=x.w[self.w], s=x.s[self.c], lam_g=x.lam_g[self.g], lam_c=x.lam_c[self.c])
        return whole._replace(start=own)


@dataclass(frozen=True, eq=False, kw_only=True)
class ArcTask:
    """One arc to solve, here or in another process."""

    key: str
    """Same for all tasks with this layout."""
    model: ModelLayout
    layout: MechanicalLayout
    data: MechanicalData
    attempts: tuple[Attempt, ...]

    def run(self) -> SparseSolution:
        """Solution of the first attempt that solves it, else of the last."""
        return solve_in_turn(MechanicalProblem(self._structure(), self.data), self.attempts)

    def _structure(self) -> MechanicalStructure:
        if self.key not in _structures:
            while len(_structures) >= MOST_STRUCTURES:
                del _structures[next(iter(_structures))]
            _structures[self.key] = MechanicalStructure(self.layout, walking_functions(self.model).functions)
        return _structures[self.key]


def solve_in_turn(problem: MechanicalProblem, attempts: Sequence[Attempt]) -> SparseSolution:
    """Solution of the first attempt that solves a problem, else of the last."""
    found = attempts[0].method.solve(problem, attempts[0].start)
    for method, start in attempts[1:]:
        if found.status is Status.SOLVED:
            break
        found = method.solve(problem, start)
    return found


COST_NOISE = 1e-6
"""Costs that differ by less, relatively, are the same: the barrier parameter alone makes such a difference."""
MOST_STRUCTURES = 64
_structures: dict[str, MechanicalStructure] = {}
"""Index tables of the arcs that this process has solved; making them takes longer than an iteration."""


class _Unknowns(NamedTuple):
    """Primal and dual unknowns."""

    w: np.ndarray
    """Variables, shape (n_w,)."""
    s: np.ndarray
    """Slacks, shape (n_c,)."""
    lam_g: np.ndarray
    """Multipliers of the equations, shape (n_g,)."""
    lam_c: np.ndarray
    """Multipliers of the inequalities, shape (n_c,)."""


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
        attempts: Sequence[Attempt],
        workers: Workers | None = None,
        done: Callable[[int], None] | None = None,
    ) -> SparseSolution:
        """Solve a problem of this structure arc by arc; attempts start from points or solutions of the whole.

        Each arc is attempted in turn until it is solved. `done(n_arcs_solved)` may raise to cancel.
        Iterations are those of the slowest arc; the status is the first that is not "solved".
        """
        found = self.solve_each(problem, attempts, workers, done)
        sizes = problem.structure
        joint = _Unknowns(np.zeros(sizes.n_w), np.zeros(sizes.n_c), np.zeros(sizes.n_g), np.zeros(sizes.n_c))
        for arc, x in zip(self.parts, found, strict=True):
            joint.w[arc.w], joint.s[arc.c], joint.lam_c[arc.c] = x.w, x.s, x.lam_c
            # The state between two arcs is given once in the whole and once in each of them: multipliers add up.
            joint.lam_g[arc.g] += x.lam_g
        status = next((x.status for x in found if x.status is not Status.SOLVED), Status.SOLVED)
        iterations = max(x.iterations for x in found)
        return certify(problem, joint, mu=max(x.mu for x in found), iterations=iterations, status=status)

    def solve_each(
        self,
        problem: MechanicalProblem,
        attempts: Sequence[Attempt],
        workers: Workers | None = None,
        done: Callable[[int], None] | None = None,
    ) -> list[SparseSolution]:
        """The same, the solutions of the arcs in the order of time."""
        tasks = [
            ArcTask(
                key=f"{self.key}-{i}",
                model=self.model,
                layout=arc.structure.layout,
                data=arc.data(problem.data),
                attempts=tuple(arc.attempt(whole) for whole in attempts),
            )
            for i, arc in enumerate(self.parts)
        ]
        finished = count(1)

        def tell(_index: int, _found: SparseSolution) -> None:
            if done is not None:
                done(next(finished))

        if workers is not None:
            return workers.map(tasks, tell)
        found: list[SparseSolution] = []
        for task in tasks:
            found.append(task.run())
            tell(len(found), found[-1])
        return found

    def improved(
        self, problem: MechanicalProblem, optimum: SparseSolution, found: Sequence[SparseSolution]
    ) -> SparseSolution:
        """An optimum with those solutions of arcs, in the order of time, that cost less by more than rounding."""
        joint = _Unknowns(optimum.w.copy(), optimum.s.copy(), optimum.lam_g.copy(), optimum.lam_c.copy())
        for arc, x in zip(self.parts, found, strict=True):
            known = MechanicalProblem(arc.structure, arc.data(problem.data)).values(optimum.w[arc.w]).f
            if x.status is Status.SOLVED and x.f < known - COST_NOISE * abs(known):
                joint.w[arc.w], joint.s[arc.c] = x.w, x.s
                joint.lam_g[arc.g], joint.lam_c[arc.c] = x.lam_g, x.lam_c
        self._set_multipliers_of_given(problem, joint)
        return certify(problem, joint, mu=optimum.mu, iterations=optimum.iterations, status=optimum.status)

    def _set_multipliers_of_given(self, problem: MechanicalProblem, x: "_Unknowns") -> None:
        """A given entry is an unknown of its own: its multiplier is what makes the point stationary there."""
        whole, sparse = self.whole, problem.structure
        derivatives = problem.derivatives(x.w, x.lam_g, x.lam_c)
        rows = sparse.n_g - len(whole.fixed_columns) + np.arange(len(whole.fixed_columns))
        x.lam_g[rows] = 0.0
        pull = derivatives.grad + multiply_transposed(sparse.jac_g, derivatives.jac_g, x.lam_g, sparse.n_w)
        pull -= multiply_transposed(sparse.jac_c, derivatives.jac_c, x.lam_c, sparse.n_w)
        x.lam_g[rows] = -pull[whole.fixed_columns]

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
