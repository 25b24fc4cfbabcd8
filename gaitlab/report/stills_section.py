"""The page of stills."""

from collections.abc import Mapping

import numpy as np

from ..clinical.document import SIDES
from ..mocap.cycle import Cycle
from ..mocap.cycles import cycles
from .blocks import Section, missing, paragraph, picture, section
from .result import Result, mapping, real, sequence
from .stills_figure import Moment, stills_figure, stride_moments
from .walk_file import Walk

CLOSE = 1e-3
"""Times of the same event differ by less [s]."""


def stills_section(result: Result, walk: Walk | None, why: str) -> Section:
    """Measured against model-optimal skeleton at the moments that divide a stride; `why` explains an absent walk."""
    title = "Stills: measured and model-optimal walk"
    if walk is None:
        return section(title, missing("stills", why))
    moments = _moments(result, walk)
    if not moments:
        return section(title, missing("stills", "no side has a complete cycle inside the recording"))
    drawn = stills_figure(walk, moments)
    if drawn is None:
        return section(title, missing("stills", "walk.npz holds no skeleton (segment_positions_measured and bones)"))
    words = (
        f"Trial {result.name}. Skeleton of the whole-model kinematics (origins of the segments and tips of the feet), "
        "moved so that the measured pelvis stays in place; scale equal in all views. The model-optimal skeleton, where "
        "there is one, is moved by the same amount: where its pelvis lies elsewhere, the model is ahead of or behind "
        "the person."
    )
    optimal = walk.vectors("segment_positions_optimal")
    gap = missing("the model-optimal skeleton", "weights and their walk were not computed") if optimal is None else None
    return section(title, picture(drawn), paragraph(words, "note"), gap)


def _moments(result: Result, walk: Walk) -> tuple[Moment, ...]:
    """Of the stride that the weights explain, else of the representative one, else of the first one."""
    cycle = explained_cycle(result, walk)
    return () if cycle is None else stride_moments(cycle)


def explained_cycle(result: Result, walk: Walk) -> Cycle | None:
    """The stride that the weights explain, else the representative one, else the first one inside the recording."""
    wanted = [*_explained(result), *_representative(result)]
    # Events may go on where the motion is unknown: a stride that can be drawn comes first.
    for first, last in (_drawable(walk), (float(walk.time[0]), float(walk.time[-1]))):
        every = [cycle for side in SIDES for cycle in cycles(result.events, side)]
        inside = [cycle for cycle in every if first - CLOSE <= cycle.start and cycle.end <= last + CLOSE]
        chosen = [cycle for stride in wanted for cycle in inside if _is(cycle, stride)]
        if inside:
            return [*chosen, *inside][0]
    return None


def _drawable(walk: Walk) -> tuple[float, float]:
    """First and last time [s] with a measured skeleton; of the whole walk where there is none."""
    positions = walk.vectors("segment_positions_measured")
    known = walk.time if positions is None else walk.time[np.isfinite(positions).any(axis=(1, 2))]
    times = known if known.size else walk.time
    return float(times[0]), float(times[-1])


def _explained(result: Result) -> list[Mapping[str, object]]:
    strides = [] if result.weights is None else sequence(result.weights.document.get("strides"))
    return [mapping(stride) for stride in strides]


def _representative(result: Result) -> list[Mapping[str, object]]:
    strides = [mapping(item) for item in sequence(result.part("strides").get("strides"))]
    return [stride for stride in strides if stride.get("representative") is True]


def _is(cycle: Cycle, stride: Mapping[str, object]) -> bool:
    start = real(stride.get("start_s"))
    return stride.get("side") == cycle.side and start is not None and abs(start - cycle.start) < CLOSE
