"""When a foot steps on a force plate and leaves it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaitlab.mocap.feet import FootMotion
from gaitlab.mocap.recording import EventKind, ForcePlate, Recording, Side
from gaitlab.signal.runs import runs

THRESHOLD = 20.0  # N, vertical; the usual choice for walking (Tirosh and Sparrow 2003 compare 5 to 25 N)
STEP = 100.0  # N; a contact reaches more, or it is noise or a brush; its edges are where it crosses THRESHOLD
MERGE = 0.02  # s; shorter interruptions do not end a contact
HEIGHT = 0.15  # m; a landing foot's marker is no higher above the plate


@dataclass(frozen=True, kw_only=True)
class PlateEdge:
    """A plate gets loaded or unloaded by one foot that is on it."""

    kind: EventKind
    time: float
    """Time [s] from the first stored frame."""
    sides: frozenset[Side]
    """Feet of which the landing or leaving end is above the plate."""


def plate_edges(recording: Recording, motions: Sequence[FootMotion]) -> list[PlateEdge]:
    """All edges of the vertical forces, with the feet that can have made them.

    Loading is the foot's strike only if the end that lands first, heel or toe, is above the plate; unloading is its
    foot off only if the toe is.
    """
    return [
        PlateEdge(
            kind=kind, time=sample / plate.rate, sides=_feet(plate, motions, kind, sample / plate.rate, recording)
        )
        for plate in recording.force_plates
        for kind, sample in _edge_samples(plate)
    ]


def _edge_samples(plate: ForcePlate) -> list[tuple[EventKind, int]]:
    """Samples at which a contact begins or ends; a contact that is cut by the end of the trial has no such end."""
    found = contacts(plate)
    strikes: list[tuple[EventKind, int]] = [("foot_strike", start) for start, _ in found if start > 0]
    offs: list[tuple[EventKind, int]] = [("foot_off", end) for _, end in found if end < len(plate.force)]
    return strikes + offs


def _feet(
    plate: ForcePlate, motions: Sequence[FootMotion], kind: EventKind, time: float, recording: Recording
) -> frozenset[Side]:
    frame = min(round(time * recording.rate), recording.n_frames - 1)
    return frozenset(motion.side for motion in motions if _above(plate, motion, frame, kind))


def contacts(plate: ForcePlate) -> list[tuple[int, int]]:
    """Runs of samples in which the plate carries a foot, as (start, end) with end exclusive."""
    vertical = plate.force[:, 2]
    above = vertical > THRESHOLD
    merged: list[tuple[int, int]] = []
    for start, end in runs(vertical > STEP):
        if merged and start - merged[-1][1] < MERGE * plate.rate:
            merged[-1] = (merged[-1][0], end)
        else:
            merged.append((start, end))
    outside = np.flatnonzero(~np.concatenate([[False], above, [False]])) - 1  # with a sample before and one after
    return [
        (int(outside[np.searchsorted(outside, start) - 1]) + 1, int(outside[np.searchsorted(outside, end)]))
        for start, end in merged
    ]


def _above(plate: ForcePlate, motion: FootMotion, frame: int, kind: EventKind) -> bool:
    """Whether the foot's landing end (the lower of heel and toe) or its toe is above the plate in this frame."""
    heel, toe = motion.heel[frame], motion.toe[frame]
    point = heel if kind == "foot_strike" and not toe[2] < heel[2] else toe
    centre = plate.corners.mean(axis=0)
    inside = [
        abs(float((point - centre) @ edge)) <= 0.5 * float(edge @ edge)
        for edge in (plate.corners[0] - plate.corners[1], plate.corners[1] - plate.corners[2])
    ]
    return all(inside) and abs(float(point[2] - centre[2])) <= HEIGHT
