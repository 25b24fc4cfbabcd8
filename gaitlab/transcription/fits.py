"""Measurements as a part of the objective: one-level parameter estimation."""

import casadi as ca
import numpy as np

from ..ocp.measurement import Measurement, check_measurement
from ..ocp.problem import MultiStageProblem
from .assembly import Piece
from .pieces import PointReader

_NO_CONSTRAINTS = ca.SX(0, 1)


def fit_pieces(problem: MultiStageProblem, reader: PointReader, measurement: Measurement) -> list[Piece]:
    """Half the squared residuals of each time, as pieces: times at left nodes, at the end, and inside intervals."""
    check_measurement(problem, measurement)
    stage = problem.stages[measurement.stage]
    layout, model = reader.layout.stages[measurement.stage], reader.models[measurement.stage]
    located = [layout.grid.locate(time) for time in measurement.times.tolist()]
    intervals, s = np.array([k for k, _ in located]), np.array([s for _, s in located])
    groups = [(model.at_left, s == 0.0), (model.at_right, s == 1.0), (model.inside, (s > 0.0) & (s < 1.0))]
    known = np.isfinite(measurement.values)
    values = np.column_stack([np.where(known, measurement.values, 0.0), np.where(known, 1.0 / measurement.sd, 0.0)])
    h = ca.Function("h", [stage.t, stage.x, stage.u, problem.q, problem.p], [measurement.function])
    unknowns, pieces = layout.interval(reader.layout.q), list[Piece]()
    for read, chosen in groups:
        times = np.flatnonzero(chosen)
        if times.size:
            place = np.column_stack([layout.grid.data[intervals[times]], s[times]])[:, : read.numel_in(1)]
            pieces.append(
                Piece(
                    function=_squares(problem, reader, read, h),
                    unknowns=unknowns[intervals[times]],
                    data=np.hstack([place, values[times]]),
                    lower=np.zeros((times.size, 0)),
                    upper=np.zeros((times.size, 0)),
                    labels=(),
                )
            )
    return pieces


def _squares(problem: MultiStageProblem, reader: PointReader, read: ca.Function, h: ca.Function) -> ca.Function:
    n_h, n_q = h.numel_out(0), problem.q.numel()
    z, place = ca.SX.sym("z", read.numel_in(0)), ca.SX.sym("place", read.numel_in(1))
    value, weight = ca.SX.sym("value", n_h), ca.SX.sym("weight", n_h)
    parameters = reader.parameters
    # The last unknowns of an interval are the control values q.
    q = z[z.numel() - n_q :]
    model = h(*read(z, place, parameters), q, parameters[len(problem.criteria) :])
    residual = weight * (model - value)
    data = ca.vertcat(place, value, weight)
    return ca.Function("fit", [z, data, parameters], [0.5 * ca.sumsqr(residual), _NO_CONSTRAINTS])
