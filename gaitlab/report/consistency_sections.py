"""Sections of every cycle: all strides of all trials as thin lines, angles and kinetics."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ..clinical.cycle_average import complete, time_normalise, time_normalise_forces
from ..clinical.document import CURVES, SIDES
from ..mocap.cycle import Cycle
from ..mocap.cycles import cycles
from .blocks import Section, missing, picture, section
from .clinical_sections import marks_of
from .kinematics_figure import consistency_figure
from .kinetics_figure import PANELS, every_cycle_figure
from .result import Result
from .score_sections import norms_of
from .source import Source
from .walk_file import Frames

Cut = Callable[[np.ndarray, float, Cycle], np.ndarray]
CycleLists = dict[str, dict[str, list[np.ndarray]]]


def angles_section(source: Source) -> Section:
    """Angles of every cycle, or why they are not shown."""
    title = "All cycles"
    found = [
        every_cycle(trial.result, trial.angles, CURVES, time_normalise)
        for trial in source.trials
        if trial.angles is not None
    ]
    if not found:
        why = " ".join(trial.problems.get("angles", "") for trial in source.trials).strip()
        return section(title, missing("every cycle", why or "angles.csv is absent"))
    curves = _together(found, CURVES)
    if _most(curves) < 2:
        return section(title, missing("every cycle", "no side has two complete cycles, so the average says it all"))
    overall = source.overall
    return section(title, picture(consistency_figure(curves, overall.kinematics, marks_of(overall), norms_of(overall))))


def kinetics_cycles_section(source: Source) -> Section:
    """Moments, powers and ground reactions of every cycle with a valid plate contact, or why they are not shown."""
    title, what = "All cycles: kinetics", "moments, powers and ground reactions of every cycle"
    names = [panel.name for panel in PANELS]
    found = [
        _whole(every_cycle(trial.result, trial.kinetics, names, time_normalise_forces))
        for trial in source.trials
        if trial.kinetics is not None
    ]
    if not found:
        why = " ".join(trial.problems.get("kinetics", "") for trial in source.trials).strip()
        return section(title, missing(what, why or "no trial has kinetics, see the page on them"))
    curves = _together(found, names)
    if _most(curves) < 2:
        why = "no side has two complete cycles with a valid plate contact"
        return section(title, missing(what, why))
    overall = source.overall
    return section(title, picture(every_cycle_figure(curves, overall.kinetics, marks_of(overall), norms_of(overall))))


def every_cycle(result: Result, frames: Frames, names: Sequence[str], cut: Cut) -> CycleLists:
    """Curves of all cycles of one trial, shape (101,) each, unit of the table: curve name to side to cycles.

    `cut` samples values per frame (n_frames,), given their rate [Hz], over a cycle.
    """
    length = float(frames.time[-1] - frames.time[0])
    if length <= 0.0:
        return {}
    rate = (len(frames.time) - 1) / length
    curves: CycleLists = {}
    for name in names:
        sides = dict[str, list[np.ndarray]]()
        for side in SIDES:
            values = frames.curves.get(f"{side}_{name}")
            if values is not None:
                sampled = [cut(values, rate, cycle) for cycle in cycles(result.events, side)]
                sides[side] = [samples for samples in sampled if np.any(np.isfinite(samples))]
        curves[name] = sides
    return curves


def _whole(curves: CycleLists) -> CycleLists:
    """Without the cycles whose ground reaction is known in part only, as the averages are."""
    return {name: {side: complete(values) for side, values in sides.items()} for name, sides in curves.items()}


def _together(found: Sequence[CycleLists], names: Sequence[str]) -> CycleLists:
    return {
        name: {side: [values for trial in found for values in trial.get(name, {}).get(side, [])] for side in SIDES}
        for name in names
    }


def _most(curves: Mapping[str, Mapping[str, Sequence[np.ndarray]]]) -> int:
    return max(len(values) for sides in curves.values() for values in sides.values())
