"""From a multi-stage problem to a nonlinear program, for any scheme inside the intervals."""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..ocp.measurement import Measurement
from ..ocp.problem import MultiStageProblem
from ..ocp.stage import Stage
from .assembly import Assembly, Piece
from .control_shapes import ControlShape
from .fits import fit_pieces
from .grid import Grid, uniform
from .layout import Layout, StageLayout, lay_out
from .pieces import PointReader, fixed_values, point_piece, stage_pieces, transition_piece
from .schemes import Scheme
from .stage_model import model_stage
from .transcribed import Transcribed

Grids = int | Sequence[int | Grid]
"""Number of equal intervals of every stage, or numbers or grids stage by stage."""


@dataclass(frozen=True, kw_only=True)
class Discretisation:
    """Everything a transcription needs besides the problem."""

    grids: Grids
    scheme: Scheme
    shape: ControlShape
    bound_inside: bool
    """Whether bounds on states hold at unknown states inside intervals too."""


def transcribe(problem: MultiStageProblem, how: Discretisation, fit: Sequence[Measurement] = ()) -> Transcribed:
    """Discretise; measurements to `fit` add their least squares to the objective (one-level estimation)."""
    grids = _grids(how.grids, len(problem.stages))
    layout = lay_out(problem, grids, how.scheme, how.shape)
    models = tuple(model_stage(problem, stage, how.scheme, how.shape) for stage in problem.stages)
    parameters = ca.vertcat(ca.SX.sym("theta", len(problem.criteria)), problem.p)
    reader = PointReader(models, layout, parameters)
    pieces = list[Piece]()
    for stage, model, places in zip(problem.stages, models, layout.stages, strict=True):
        pieces += stage_pieces(stage, model, places, layout.q, how.scheme.path_at_end)
    for k, transition in enumerate(problem.transitions):
        pieces.append(transition_piece(problem, k, transition, layout, parameters))
    pieces += fixed_values(problem.control_value_bounds, layout.q, layout.names, parameters.numel())
    pieces += [point_piece(reader, each, problem.q) for each in problem.points]
    pieces += [piece for each in fit for piece in fit_pieces(problem, reader, each)]
    assembly = Assembly(w=ca.SX.sym("w", layout.n_w), p=parameters, pieces=tuple(pieces))
    return Transcribed(
        problem=problem,
        nlp=assembly.nlp(*_bounds(problem, layout, how.bound_inside)),
        layout=layout,
        models=models,
        constraint_names=assembly.labels,
        inside_times=how.scheme.inside_times(),
    )


def _grids(grids: Grids, n_stages: int) -> tuple[Grid, ...]:
    each = [grids] * n_stages if isinstance(grids, int) else list(grids)
    if len(each) != n_stages:
        raise ProblemError(f"{n_stages} stages need as many grids, got {len(each)}")
    return tuple(uniform(grid) if isinstance(grid, int) else grid for grid in each)


def _bounds(problem: MultiStageProblem, layout: Layout, bound_inside: bool) -> tuple[np.ndarray, np.ndarray]:
    lower, upper = np.full(layout.n_w, -np.inf), np.full(layout.n_w, np.inf)
    q = problem.control_value_bounds
    lower[layout.q], upper[layout.q] = np.where(q.fixed, -np.inf, q.lower), np.where(q.fixed, np.inf, q.upper)
    for stage, places in zip(problem.stages, layout.stages, strict=True):
        _bound_stage(stage, places, (lower, upper), bound_inside)
    return lower, upper


def _bound_stage(stage: Stage, places: StageLayout, bounds: tuple[np.ndarray, np.ndarray], bound_inside: bool) -> None:
    lower, upper = bounds
    n = places.grid.n
    for k in range(n + 1):
        at = stage.bounds_at(start=k == 0, end=k == n)
        # Fixed values are equations, see `pieces.fixed_values`.
        free = at.fixed & ((k == 0) | (k == n))
        lower[places.x[k]], upper[places.x[k]] = np.where(free, -np.inf, at.lower), np.where(free, np.inf, at.upper)
    lower[places.c[:, : stage.n_u]], upper[places.c[:, : stage.n_u]] = (
        stage.control_bounds.lower, stage.control_bounds.upper
    )  # fmt: skip
    if bound_inside and places.inside.size:
        points = places.inside.reshape(n, -1, stage.n_x)
        lower[points], upper[points] = stage.state_bounds.lower, stage.state_bounds.upper
