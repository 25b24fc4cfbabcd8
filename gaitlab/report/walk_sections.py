"""Sections on the walk of the model: joint angles, contact forces, share of each criterion over the cycle."""

import numpy as np

from .blocks import Block, Section, missing, paragraph, picture, section
from .result import Result
from .share_figure import share_figure
from .stills_figure import stride_moments
from .stills_section import explained_cycle
from .walk_figure import forces_figure, joints_figure, modelled_part, phase_spans
from .walk_file import Walk
from .weights_sections import NOT_CONVERGED


def walk_sections(result: Result, walk: Walk | None, why: str) -> tuple[Section, ...]:
    """Measured and model-optimal walk in time, forces, share of each criterion; `why` explains an absent walk."""
    title = "The walk of the model"
    if walk is None:
        return (section(title, missing("measured and model-optimal walk", why)),)
    part = modelled_part(walk)
    converged = result.weights is None or result.weights.converged
    mark = None if converged else paragraph(NOT_CONVERGED, "stamp")
    return (section(title, mark, *_joints(part)), _forces(result, part))


def _joints(walk: Walk) -> list[Block | None]:
    drawn = joints_figure(walk)
    if drawn is None:
        return [missing("joint angles of the model", "walk.npz has no q_measured")]
    absent = (
        missing("model-optimal curves", "walk.npz has no q_optimal") if walk.numbers("q_optimal", 2) is None else None
    )
    words = (
        "Degrees over time in seconds, coordinates of the model (rotations "
        "about y, x, z of each joint), with the model's signs, which are not the clinical signs above. "
    )
    spans = [f"{name} {start:.2f}–{end:.2f} s" for name, start, end in phase_spans(walk)]
    shaded = f"Shaded: phases ({'; '.join(spans)})." if spans else "Phases are not shaded: walk.npz has no phase."
    return [picture(drawn), paragraph(words + shaded, "note"), absent]


def _forces(result: Result, walk: Walk) -> Section:
    title = "Contact forces"
    drawn = forces_figure(walk, result.mass)
    if drawn is None:
        return section(title, missing("contact forces", "walk.npz has neither forces_optimal nor grf_plates"))
    words = "Forward is the way of the pelvis on the floor. Plates are not assigned to feet here."
    absent = [
        missing(what, f"walk.npz has no {key}")
        for key, what in (("forces_optimal", "forces of the model"), ("grf_plates", "forces of the plates"))
        if walk.vectors(key) is None
    ]
    return section(title, picture(drawn), paragraph(words, "note"), *absent)


def share_section(result: Result, walk: Walk | None, why: str) -> Section:
    """Share of each criterion in the cost over the cycle; `why` explains an absent walk."""
    title = "Criteria over the cycle"
    if walk is None:
        return section(title, missing("share of each criterion over the cycle", why))
    share = walk.numbers("criteria_share", 2)
    if share is None:
        return section(title, missing("share of each criterion over the cycle", "walk.npz has no criteria_share"))
    criteria = [] if result.weights is None else [criterion.name for criterion in result.weights.criteria]
    stored = list(walk.names("criteria_names")) or criteria
    names = (stored + [f"criterion {k + 1}" for k in range(len(stored), share.shape[1])])[: share.shape[1]]
    stride = explained_cycle(result, walk)
    if stride is None:
        why = "no stride of the recording has been explained from foot strike to foot strike"
        return section(title, missing("share of each criterion over the cycle", why))
    percent = 100.0 * (walk.time - stride.start) / stride.duration
    inside = (percent >= 0.0) & (percent <= 100.0) & np.isfinite(share).all(axis=1)
    words = (
        f"Stride of the {stride.side} side, {stride.start:.2f} to {stride.end:.2f} s. Each criterion's running cost, "
        "weighted, divided by the sum of all at that instant: when the model pays for what, not how much it pays."
    )
    marks = {
        moment.name: moment.percent for moment in stride_moments(stride) if "foot" in moment.name and moment.percent
    }
    return section(title, picture(share_figure(percent[inside], share[inside], names, marks)), paragraph(words, "note"))
