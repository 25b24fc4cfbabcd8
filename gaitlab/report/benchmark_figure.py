"""Figures of the optimal control benchmarks, like Hatz (2014), figures 14.1, 14.3, 14.5, 14.7 and 14.8."""

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from ..ocp.measurement import Measurement
from ..ocp.problem import MultiStageProblem
from ..ocp.symbols import element_names
from ..ocp.trajectory import StageTrajectory, Trajectory

MEASURED, OPTIMAL = "0.45", "black"
COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown", "tab:pink", "tab:olive")
# matplotlib writes random identifiers and the date unless told otherwise; the same input must give the same bytes.
_SVG: dict[Any, str] = {"svg.hashsalt": "gaitlab", "svg.fonttype": "none"}


def time_courses(
    problem: MultiStageProblem,
    optimum: Trajectory,
    estimates: Mapping[str, Trajectory],
    measured: Sequence[Measurement],
) -> str:
    """SVG of states and controls over the fraction of the duration.

    Circles are measurements, the dashed line is the optimum for the true parameters, solid lines are estimates.
    """
    stage = problem.stages[0]
    names = [*element_names(stage.x), *element_names(stage.u)]
    columns = 3
    figure = Figure(figsize=(4.0 * columns, 2.4 * -(-len(names) // columns)), layout="constrained")
    for i, name in enumerate(names):
        axes = figure.add_subplot(-(-len(names) // columns), columns, i + 1)
        _course(axes, i, stage.n_x, optimum.stages[0], {"color": OPTIMAL, "linestyle": "--", "label": "optimum"})
        for (label, trajectory), colour in zip(estimates.items(), _colours(len(estimates)), strict=True):
            _course(axes, i, stage.n_x, trajectory.stages[0], {"color": colour, "label": label, "linewidth": 1.0})
        _circles(axes, i, stage.n_x, measured)
        axes.set_title(name, fontsize="medium")
        axes.set_xlabel("t / T")
    lines, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(lines, labels, loc="outside upper center", ncols=4, fontsize="x-small")
    return as_svg(figure)


def path_in_plane(optimum: Trajectory, estimates: Mapping[str, Trajectory], title: str) -> str:
    """SVG of the first two states against each other, headings as ticks: the way of a car (figure 14.4)."""
    figure = Figure(figsize=(5.0, 5.0), layout="constrained")
    axes = figure.add_subplot()
    x = optimum.stages[0].x
    axes.plot(x[:, 0], x[:, 1], color=OPTIMAL, linestyle="--", label="optimum")
    axes.quiver(x[:, 0], x[:, 1], np.cos(x[:, 2]), np.sin(x[:, 2]), color="0.6", width=0.004, scale=25)
    for (label, trajectory), colour in zip(estimates.items(), _colours(len(estimates)), strict=True):
        axes.plot(*trajectory.stages[0].x[:, :2].T, color=colour, label=label, linewidth=1.0)
    axes.set_aspect("equal")
    axes.set_title(title)
    axes.legend(fontsize="small", loc="lower right")
    return as_svg(figure)


def arm_postures(optimum: Trajectory, title: str) -> str:
    """SVG of the robot's arm from the side, one line per node of (phi_1, phi_2, r) (figure 14.6)."""
    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    axes = figure.add_subplot()
    stage, shaft = optimum.stages[0], 1.5
    for k, (pitch, extension) in enumerate(stage.x[:, 1:3]):
        along = np.array([np.cos(pitch), np.sin(pitch)])
        ends = np.outer([extension - shaft / 2, extension + shaft / 2], along)
        shade = str(0.8 * (1.0 - k / (len(stage.x) - 1)))
        axes.plot(*ends.T, color=shade, linewidth=3, solid_capstyle="round", label=f"{stage.t[k]:.2f} s")
    axes.plot([0.0], [0.0], "^", color="tab:red", markersize=9)
    axes.set_aspect("equal")
    axes.set_xlabel("[m]")
    axes.set_title(title)
    axes.legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return as_svg(figure)


def _colours(n: int) -> list[str]:
    return [COLOURS[i % len(COLOURS)] for i in range(n)]


def _course(axes: Axes, i: int, n_x: int, stage: StageTrajectory, style: dict[str, object]) -> None:
    if i < n_x:
        axes.plot(stage.fraction, stage.x[:, i], **style)  # pyright: ignore[reportArgumentType]
    else:
        axes.step(stage.fraction, stage.u[:, i - n_x], where="post", **style)  # pyright: ignore[reportArgumentType]


def _circles(axes: Axes, i: int, n_x: int, measured: Sequence[Measurement]) -> None:
    """Measurements of all states or of all controls, in their order, by name."""
    for each in measured:
        column = i if each.name == "states" else i - n_x
        if (each.name == "states") == (i < n_x) and 0 <= column < each.values.shape[1]:
            axes.plot(each.times, each.values[:, column], "o", color=MEASURED, markersize=3, fillstyle="none")


def as_svg(figure: Figure) -> str:
    """The figure as SVG text; the same input gives the same bytes."""
    text = io.StringIO()
    with rc_context(_SVG):
        FigureCanvasSVG(figure).print_svg(text, metadata={"Date": None})
    return text.getvalue()
