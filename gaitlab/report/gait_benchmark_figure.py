"""Figures of the gait benchmark, like Hatz (2014), figures 15.3 to 15.14."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from ..walking.gait_courses import GaitCourses
from .benchmark_figure import as_svg

COORDINATES = ("pelvis x", "pelvis y", "pelvis z", *(
    f"{part} {axis}"
    for part in ("pelvis", "right hip", "right knee", "right ankle", "left hip", "left knee", "left ankle")
    for axis in ("y", "x", "z")
))  # fmt: skip
"""Table 15.1."""

COLUMNS = 6


def coordinates(course: GaitCourses, title: str) -> str:
    """SVG of measured and optimal coordinates over time (figures 15.3, 15.4, 15.9, 15.10)."""
    figure = _grid(course, [x[:, :24] for x in course.states], course.times, COORDINATES, title)
    for i, axes in enumerate(figure.axes):
        for t, q in zip(course.times, course.measured, strict=True):
            axes.plot(t, q[:, i], "o", color="0.5", markersize=2, fillstyle="none", zorder=0)
    return as_svg(figure)


def velocities(course: GaitCourses, title: str) -> str:
    """SVG of the optimal velocities over time (figures 15.5, 15.11)."""
    return as_svg(_grid(course, [x[:, 24:] for x in course.states], course.times, COORDINATES, title))


def torques(course: GaitCourses, title: str) -> str:
    """SVG of the optimal joint torques over time (figures 15.6, 15.12)."""
    return as_svg(_grid(course, course.torques, course.torque_times, COORDINATES[6:], title))


def postures(course: GaitCourses, title: str, lateral: bool) -> str:
    """SVG of stick figures, measured beside optimal, from the side or from the front (15.7, 15.8, 15.13, 15.14)."""
    figure = Figure(figsize=(11.0, 4.0), layout="constrained")
    axes = figure.add_subplot()
    for chains, colour, label in ((course.measured_joints, "0.6", "measured"), (course.joints, "tab:blue", "optimal")):
        for chain in chains:
            for k, points in enumerate(chain):
                # Seen from the front all postures stand in one place: they are set side by side.
                across = points[:, 0] if lateral else points[:, 1] + 0.6 * k
                name = label if k == 0 and chain is chains[0] else None
                axes.plot(across, points[:, 2], "-o", color=colour, markersize=2, linewidth=1, label=name)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]" if lateral else "y, one posture after the other [m]")
    axes.set_ylabel("z [m]")
    axes.set_title(title)
    axes.legend(fontsize="small")
    return as_svg(figure)


def _grid(
    course: GaitCourses, curves: Sequence[np.ndarray], times: Sequence[np.ndarray], names: Sequence[str], title: str
) -> Figure:
    rows = -(-len(names) // COLUMNS)
    figure = Figure(figsize=(2.4 * COLUMNS, 1.7 * rows), layout="constrained")
    for i, name in enumerate(names):
        axes = figure.add_subplot(rows, COLUMNS, i + 1)
        for t, values in zip(times, curves, strict=True):
            axes.plot(t, values[:, i], color="tab:blue", linewidth=1.2)
        for t in course.times[1:]:
            axes.axvline(float(t[0]), color="0.85", linewidth=0.8, zorder=0)
        axes.set_title(name, fontsize="small")
        axes.tick_params(labelsize="x-small")
    figure.suptitle(title)
    return figure
