"""The pieces of a transcribed problem: intervals, fixed values, transitions, constraints at points."""

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np

from ..ocp.constraint import Bounds, Point, PointConstraint
from ..ocp.problem import MultiStageProblem
from ..ocp.stage import Stage
from ..ocp.symbols import element_names
from ..ocp.transition import Transition
from .assembly import Piece
from .layout import Layout, StageLayout
from .stage_model import StageModel

NO_DATA = np.zeros((1, 0))


def stage_pieces(
    stage: Stage, model: StageModel, layout: StageLayout, q: np.ndarray, path_at_end: bool
) -> Iterator[Piece]:
    """Intervals, end of the stage, and fixed values of one stage; q are places of shape (n_q,)."""
    unknowns = layout.interval(q)
    yield _intervals(stage, model, layout, unknowns)
    if path_at_end and model.end_path.numel_out(1):
        path = stage.path.bounded()
        yield Piece(
            function=model.end_path, unknowns=unknowns[-1:], data=layout.grid.data[-1:], lower=path.lower[None],
            upper=path.upper[None], labels=tuple(_path_labels(stage, f"at the end of stage '{stage.name}'")),
        )  # fmt: skip
    if stage.mayer:
        places = np.concatenate([layout.x[-1], q])[None]
        empty = np.zeros((1, 0))
        yield Piece(function=model.mayer, unknowns=places, data=NO_DATA, lower=empty, upper=empty, labels=())
    for when, bounds, places in (("start", stage.start, layout.x[0]), ("end", stage.end, layout.x[-1])):
        if bounds is not None:
            names = [f"{name} at the {when} of stage '{stage.name}'" for name in element_names(stage.x)]
            yield from fixed_values(bounds, places, names, model.interval.numel_in(2))


def _intervals(stage: Stage, model: StageModel, layout: StageLayout, unknowns: np.ndarray) -> Piece:
    n, path, controls = layout.grid.n, stage.path.bounded(), stage.control_bounds
    bounded = np.flatnonzero(controls.finite)
    repeats = model.n_path // max(path.lower.size, 1)
    n_inner = model.interval.numel_out(1) - model.n_defects - model.n_path
    inner_repeats = n_inner // max(bounded.size, 1)
    zeros = np.zeros(model.n_defects)
    lower = [zeros, np.tile(path.lower, repeats), np.tile(controls.lower[bounded], inner_repeats)]
    upper = [zeros, np.tile(path.upper, repeats), np.tile(controls.upper[bounded], inner_repeats)]
    states, control_names = element_names(stage.x), element_names(stage.u)
    labels = list[str]()
    for k in range(n):
        where = f"in interval {k} of stage '{stage.name}'"
        labels += [f"the differential equation of {states[i % stage.n_x]} {where}" for i in range(model.n_defects)]
        labels += _path_labels(stage, where) * repeats
        labels += [f"the bounds of {control_names[i]} {where}" for i in bounded.tolist()] * inner_repeats
    return Piece(
        function=model.interval, unknowns=unknowns, data=layout.grid.data, lower=np.tile(np.concatenate(lower), (n, 1)),
        upper=np.tile(np.concatenate(upper), (n, 1)), labels=tuple(labels),
    )  # fmt: skip


def _path_labels(stage: Stage, where: str) -> list[str]:
    n = stage.path.bounded().lower.size
    return [f"path constraint '{stage.path.name}'{f'[{i}]' if n > 1 else ''} {where}" for i in range(n)]


def fixed_values(bounds: Bounds, places: np.ndarray, names: Sequence[str], n_p: int) -> Iterator[Piece]:
    """Equal bounds as equations: solvers treat variables that cannot move in very different ways.

    `places` has the shape (n,) of the bounds.
    """
    chosen = np.flatnonzero(bounds.fixed)
    if chosen.size:
        z = ca.SX.sym("z", chosen.size)
        function = ca.Function("fixed", [z, ca.SX.sym("d", 0), ca.SX.sym("p", n_p)], [ca.SX(0), z])
        value = bounds.lower[chosen][None]
        yield Piece(
            function=function, unknowns=places[chosen][None], data=NO_DATA, lower=value, upper=value,
            labels=tuple(f"the fixed value of {names[i]}" for i in chosen.tolist()),
        )  # fmt: skip


def transition_piece(
    problem: MultiStageProblem, k: int, transition: Transition, layout: Layout, parameters: ca.SX
) -> Piece:
    """Equations between the end of stage k and the start of the next."""
    before, after = problem.stages[k], problem.stages[k + 1]
    first = ca.SX.sym("first", after.n_x)
    z = ca.vertcat(before.x, first, problem.q)
    function = ca.Function(
        "transition", [z, ca.SX.sym("d", 0), parameters], [ca.SX(0), ca.densify(transition.next_state - first)]
    )
    where = f"between stages '{before.name}' and '{after.name}'"
    zeros = np.zeros((1, after.n_x))
    return Piece(
        function=function,
        unknowns=np.concatenate([layout.stages[k].x[-1], layout.stages[k + 1].x[0], layout.q])[None],
        data=NO_DATA,
        lower=zeros,
        upper=zeros,
        labels=tuple(f"the transition of {name} {where}" for name in element_names(after.x)),
    )


class PointReader:
    """Time, state and control at any time as expressions of the unknowns."""

    def __init__(self, models: Sequence[StageModel], layout: Layout, parameters: ca.SX) -> None:
        self.models, self.layout, self.parameters = models, layout, parameters

    def unknowns(self, stage: int, time: float) -> np.ndarray:
        """Places of the unknowns that matter at a fraction of a stage, shape (n_z,)."""
        k, _ = self.layout.stages[stage].grid.locate(time)
        return self.layout.stages[stage].interval(self.layout.q)[k]

    def read(self, stage: int, time: float, z: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """(t, x, u) from those unknowns."""
        layout, model = self.layout.stages[stage], self.models[stage]
        k, s = layout.grid.locate(time)
        d = layout.grid.data[k]
        read = model.at_left if s == 0.0 else model.at_right if s == 1.0 else model.inside
        t, x, u = read.call([z, ca.SX(np.append(d, s)[: read.numel_in(1)]), self.parameters])
        return t, x, u


def point_expression(reader: PointReader, constraint: PointConstraint, w: ca.SX, q: ca.SX) -> ca.SX:
    """The constraint's expression with the unknowns w put in for its points, shape (n, 1)."""
    symbols, values = [q], [w[reader.layout.q.tolist()]]
    for point in constraint.points:
        _, x, u = reader.read(point.stage, point.time, w[reader.unknowns(point.stage, point.time).tolist()])
        symbols += [point.x, *([point.u] if point.u.numel() else [])]
        values += [x, *([u] if point.u.numel() else [])]
    return ca.substitute([constraint.constraint.expression], symbols, values)[0]


def point_piece(reader: PointReader, each: PointConstraint, q: ca.SX) -> Piece:
    """A constraint between points as a piece of its own."""
    places = [reader.unknowns(point.stage, point.time) for point in each.points]
    unique = np.unique(np.concatenate([reader.layout.q, *places]))
    z, whole = ca.SX.sym("z", unique.size), ca.SX.zeros(reader.layout.n_w)
    whole[unique.tolist()] = z
    rule = each.constraint.bounded()
    expression = point_expression(reader, PointConstraint(points=each.points, constraint=rule), whole, q)
    function = ca.Function("point", [z, ca.SX.sym("d", 0), reader.parameters], [ca.SX(0), ca.densify(expression)])
    times = ", ".join(f"{_when(point)}" for point in each.points)
    return Piece(
        function=function, unknowns=unique[None], data=NO_DATA, lower=rule.lower[None], upper=rule.upper[None],
        labels=tuple(f"point constraint '{rule.name}' ({times})" for _ in range(rule.lower.size)),
    )  # fmt: skip


def _when(point: Point) -> str:
    return f"stage {point.stage} at {point.time:g}"
