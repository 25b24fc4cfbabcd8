"""Which part of each foot stands on the floor, frame by frame, from events and the model's own sole."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import InvalidRecording
from ..mocap.recording import Event, Side, SoleChange, SoleChangeKind
from ..multibody.kinematics import point_positions
from ..multibody.subject import SubjectModel

FREE, HEEL, FLAT, TOE = "free", "heel", "flat", "toe"
STATES = (FREE, HEEL, FLAT, TOE)
SIDES: tuple[Side, Side] = ("right", "left")
"""Order of the columns of the phases."""


@dataclass(frozen=True, kw_only=True)
class SoleSettings:
    """When a standing foot counts as flat.

    Heights of heel and toe point are taken over their levels in the foot's own foot flat, and the lower of the two
    carries the foot. The two heights are those of design/numerics.md, item 12.
    """

    toe_height: float = 0.008
    """A toe higher than this over a planted heel has not landed [m]."""
    heel_height: float = 0.015
    """A heel higher than this over a planted toe has risen [m]; tissue is thicker under the heel."""
    resting_speed: float = 0.15
    """Heel and toe rest together below this share of the walking speed: foot flat."""
    largest_tilt: float = 0.02
    """A foot that rests with heel and toe further apart in height [m] is no flat foot: the heel of a toe walker."""


DEFAULTS = SoleSettings()


@dataclass(frozen=True, kw_only=True)
class GaitEvents:
    """What is known of the feet of a trial from events, file's or detected."""

    feet: Sequence[Event]
    """Foot strikes and foot offs of both sides, in any order."""
    soles: Sequence[SoleChange] = ()
    """Foot flats and heel offs that somebody marked."""


def contact_phases(
    subject: SubjectModel, q: np.ndarray, rate: float, events: GaitEvents, settings: SoleSettings = DEFAULTS
) -> np.ndarray:
    """State of the right and the left foot: "free", "heel", "flat" or "toe", shape (n_frames, 2).

    A foot stands from the frame nearest to a foot strike up to the one nearest to the next foot off. Which part stands
    follows from h = z_heel - z_toe of the model's contact points, less its value in foot flat: heel while
    h < -toe_height, toe while h > heel_height, flat between. Nothing is assumed about their order. Where a foot flat or
    heel off is marked in a stance, the marks are believed instead: flat from the one to the other, toe after the heel
    off, and before the foot flat whichever part is lower there.

    Args:
        subject: The person's model.
        q: Coordinates, gait frame [m, rad], shape (n_frames, n_q). Where NaN, h is interpolated within the stance;
            a stance without any known frame is taken as flat.
        rate: Frames per second [Hz].
        events: Of both sides.
        settings: Thresholds.

    Raises:
        InvalidRecording: A side has no event.
    """
    points = point_positions(subject, subject.contacts, q)
    walking_speed = _median_speed(q[:, :2], rate)
    phases = np.full((len(q), 2), FREE, dtype="<U4")
    for column, side in enumerate(SIDES):
        heel, toe = points[f"{side}_heel"], points[f"{side}_toe"]
        stances = stance_frames(events.feet, side, rate, len(q))
        rise = heel[:, 2] - toe[:, 2]
        resting = np.maximum(_speed(heel, rate), _speed(toe, rate)) < settings.resting_speed * walking_speed
        rise = rise - _flat_level(rise, resting, stances, settings.largest_tilt)
        for stance in stances:
            own = _marks(events.soles, side, rate, stance)
            parts = _marked_parts(rise[stance], own) if own else _parts(rise[stance], settings)
            phases[stance, column] = parts
    return phases


def stance_frames(events: Sequence[Event], side: Side, rate: float, n_frames: int) -> list[slice]:
    """Stances of one foot as ranges of frames; `rate` in frames per second [Hz]."""
    own = sorted((event for event in events if event.side == side), key=lambda event: event.time)
    if not own:
        raise InvalidRecording(
            f"the {side} foot has no event; foot strikes and foot offs of both feet are needed to know which foot "
            "stands: let them be detected again or give another walk"
        )
    stances: list[slice] = []
    start: int | None = 0 if own[0].kind == "foot_off" else None
    for event in own:
        frame = min(max(round(event.time * rate), 0), n_frames)
        if event.kind == "foot_strike":
            start = frame if start is None else start
        elif start is not None:
            stances.append(slice(start, frame))
            start = None
    if start is not None:
        stances.append(slice(start, n_frames))
    return stances


def foot_directions(subject: SubjectModel, q: np.ndarray, phases: np.ndarray) -> tuple[float, float]:
    """Directions from heel to toe of the right and left standing foot, about z from x (forward) [rad].

    Zero for a foot that never stands in a known frame. Shapes: `q` (n_frames, n_q) [m, rad], `phases` (n_frames, 2).
    """
    points = point_positions(subject, subject.contacts, q)
    found: list[float] = []
    for column, side in enumerate(SIDES):
        along = (points[f"{side}_toe"] - points[f"{side}_heel"])[phases[:, column] != FREE, :2]
        along = along[np.isfinite(along).all(axis=1)]
        total = along.sum(axis=0)
        found.append(float(np.arctan2(total[1], total[0])))
    return found[0], found[1]


def _flat_level(rise: np.ndarray, resting: np.ndarray, stances: Sequence[slice], largest: float) -> float:
    """Height of the heel over the toe in foot flat [m]: zero, the model's own sole, where the foot never rests flat."""
    stands = np.zeros(len(rise), dtype=bool)
    for stance in stances:
        stands[stance] = True
    flat = rise[stands & resting & np.isfinite(rise)]
    level = float(np.median(flat)) if len(flat) else 0.0
    return level if abs(level) <= largest else 0.0


def _parts(rise: np.ndarray, settings: SoleSettings) -> np.ndarray:
    """States along one stance from the heel's height over the toe [m], shape (n,)."""
    known = np.isfinite(rise)
    if not known.any():
        return np.full(len(rise), FLAT)
    frames = np.arange(len(rise))
    filled = np.interp(frames, frames[known], rise[known])
    return np.where(filled < -settings.toe_height, HEEL, np.where(filled > settings.heel_height, TOE, FLAT))


def _marks(soles: Sequence[SoleChange], side: Side, rate: float, stance: slice) -> dict[SoleChangeKind, int]:
    """Frames of a foot's marked changes from the beginning of a stance in which they lie."""
    frames: list[tuple[SoleChangeKind, int]] = [(c.kind, round(c.time * rate)) for c in soles if c.side == side]
    return {kind: frame - stance.start for kind, frame in frames if stance.start <= frame <= stance.stop}


def _marked_parts(rise: np.ndarray, marks: Mapping[SoleChangeKind, int]) -> np.ndarray:
    """States along one stance from marked frames and the heel's height over the toe [m], NaN where unknown, (n,)."""
    frames = np.arange(len(rise))
    flat, off = marks.get("foot_flat", 0), marks.get("heel_off", len(rise))
    before = rise[: max(flat, 1)]
    first = TOE if np.sum(before[np.isfinite(before)]) > 0.0 else HEEL
    return np.where(frames < flat, first, np.where(frames < off, FLAT, TOE))


def _speed(positions: np.ndarray, rate: float) -> np.ndarray:
    """Speeds [m/s], shape (n,), by central differences; NaN beside unknown positions (n, k) [m]."""
    if len(positions) < 2:
        return np.zeros(len(positions))
    return np.linalg.norm(np.gradient(positions, 1.0 / rate, axis=0), axis=1)


def _median_speed(positions: np.ndarray, rate: float) -> float:
    speed = _speed(positions, rate)
    known = speed[np.isfinite(speed)]
    return float(np.median(known)) if len(known) else 0.0
