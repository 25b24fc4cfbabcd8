"""A transcribed problem: the nonlinear program, and how to read it."""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..nlp.problem import NLP
from ..ocp.constraint import PointConstraint
from ..ocp.measurement import Measurement, check_measurement
from ..ocp.problem import MultiStageProblem
from ..ocp.trajectory import StageTrajectory, Trajectory
from .layout import Layout, StageLayout
from .pieces import PointReader, point_expression
from .stage_model import StageModel


@dataclass(frozen=True, kw_only=True, eq=False)
class Transcribed:
    """Nonlinear program of a multi-stage problem; its parameters are (theta, p)."""

    problem: MultiStageProblem
    nlp: NLP
    layout: Layout
    models: tuple[StageModel, ...]
    constraint_names: tuple[str, ...]
    """What each constraint g says."""
    inside_times: np.ndarray
    """Fractions of an interval at which states inside are unknowns, shape (n_inside,)."""

    @property
    def variable_names(self) -> tuple[str, ...]:
        """What each unknown w is."""
        return self.layout.names

    def start(self, trajectory: Trajectory) -> np.ndarray:
        """Unknowns that resemble a trajectory, shape (n_w,); for instance a solution on another grid."""
        w = np.zeros(self.layout.n_w)
        if trajectory.q.shape != self.layout.q.shape:
            raise ProblemError(f"q of the start must have shape {self.layout.q.shape}, got {trajectory.q.shape}")
        if len(trajectory.stages) != len(self.models):
            raise ProblemError(f"the start must have {len(self.models)} stages, got {len(trajectory.stages)}")
        w[self.layout.q] = trajectory.q
        for layout, stage in zip(self.layout.stages, trajectory.stages, strict=True):
            self._fill(w, layout, stage)
        return w

    def _fill(self, w: np.ndarray, layout: StageLayout, stage: StageTrajectory) -> None:
        nodes, widths = layout.grid.nodes, np.diff(layout.grid.nodes)
        w[layout.x] = stage.state_at(nodes)
        n_u = stage.u.shape[1]
        w[layout.c[:, :n_u]] = stage.control_at(nodes[: len(layout.c)])
        if self.inside_times.size:
            times = nodes[:-1, None] + widths[:, None] * self.inside_times
            w[layout.inside] = stage.state_at(times.ravel()).reshape(layout.inside.shape)

    def trajectory(self, w: np.ndarray, p: np.ndarray, per_interval: int = 1) -> Trajectory:
        """States and controls at nodes and between, from w, shape (n_w,), and (theta, p), shape (n_p,)."""
        stages = tuple(
            self._stage_trajectory(model, layout, (w, p), per_interval)
            for model, layout in zip(self.models, self.layout.stages, strict=True)
        )
        return Trajectory(stages=stages, q=w[self.layout.q])

    def _stage_trajectory(
        self, model: StageModel, layout: StageLayout, point: tuple[np.ndarray, np.ndarray], per_interval: int
    ) -> StageTrajectory:
        w, p = point
        n = layout.grid.n
        z = w[layout.interval(self.layout.q)]
        k = np.append(np.repeat(np.arange(n), per_interval), n - 1)
        s = np.append(np.tile(np.arange(per_interval) / per_interval, n), 1.0)
        d = np.column_stack([layout.grid.data[k], s])
        _, x, u = model.inside.map(len(k))(z[k].T, d.T, p)
        x, u = np.array(x).T, np.array(u).T
        # Nodes are unknowns themselves, exact to the last bit.
        x[s == 0.0], x[-1] = w[layout.x[:-1]], w[layout.x[-1]]
        duration = model.duration(w[self.layout.q], p[len(self.problem.criteria) :])
        fraction = layout.grid.nodes[k] + s * layout.grid.data[k, 1]
        return StageTrajectory(fraction=fraction, duration=float(duration), x=x, u=u)

    def response(self, measurement: Measurement) -> ca.SX:
        """Model values of a measurement in (nlp.w, nlp.p), shape (n_t, n_h)."""
        check_measurement(self.problem, measurement)
        stage = self.problem.stages[measurement.stage]
        symbols = [stage.t, stage.x, stage.u, self.problem.q, self.problem.p]
        function = ca.Function("h", symbols, [measurement.function])
        w, p = self.nlp.w, self.nlp.p
        q, reader, rows = w[self.layout.q.tolist()], self._reader(), list[ca.SX]()
        for time in measurement.times.tolist():
            z = w[reader.unknowns(measurement.stage, time).tolist()]
            rows.append(function(*reader.read(measurement.stage, time, z), q, p[len(self.problem.criteria) :]).T)
        return ca.vertcat(*rows)

    def residual(self, measurements: Sequence[Measurement]) -> ca.SX:
        """(model - measurement) / standard deviation in (nlp.w, nlp.p), row by row, shape (n_m, 1)."""
        columns = list[ca.SX]()
        for each in measurements:
            residual = ca.vec(((self.response(each) - each.values) / each.sd).T)
            columns.append(residual[np.flatnonzero(np.isfinite(each.values.ravel())).tolist()])
        return ca.vertcat(ca.SX(0, 1), *columns)

    def expression(self, constraint: PointConstraint) -> ca.SX:
        """A function of states at several points in (nlp.w, nlp.p), for instance an upper-level constraint."""
        self.problem.check_point_constraint(constraint)
        return point_expression(self._reader(), constraint, self.nlp.w, self.problem.q)

    def _reader(self) -> PointReader:
        return PointReader(self.models, self.layout, self.nlp.p)
