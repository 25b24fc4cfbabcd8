"""Which foot stood on which force plate, and whether the plate measured that foot's ground reaction and nothing else.

A contact is one foot's when the centre of pressure stays inside that foot's outline; it is rejected, with the reason,
when the other foot stands on the same plate or when part of the foot stands beside it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gaitlab.mocap.feet import FootMotion, foot_motion
from gaitlab.mocap.force_plates import at_video_frames, centre_of_pressure
from gaitlab.mocap.plate_contacts import contacts
from gaitlab.mocap.recording import Event, ForcePlate, Recording, Side

SIDES: tuple[Side, Side] = ("left", "right")
CUT_OFF = 10.0  # Hz; of the foot markers, only their place and whether they stand matter
LOADED = 40.0  # N; below it the centre of pressure is too uncertain to tell feet apart
BEHIND, BEYOND, BESIDE = (
    0.4,
    0.6,
    0.35,
)  # of the foot's length: outline behind the heel, before and beside the toe marker
OWN = 0.95  # share of the load whose centre of pressure must lie inside the outline of one foot
FOREIGN = 0.5  # share that tells whose foot it is at all
STANDING = 0.35  # m/s; heel or toe of a standing foot is slower
LOW = 0.15  # m above the plate; markers of a standing foot are no higher
OTHER_FOOT = 0.03  # s that the other foot must stand on the plate to spoil it
EDGE = 0.025  # m; a heel or toe marker that far beside the plate still has its sole on it
RAISED = 0.05  # m above the lowest plate; toes that overhang a step touch nothing
PAUSE = 0.2  # s without load; the shortest swing is longer
STANCE_TOLERANCE = 0.1  # s between plate and events, more than detection is ever wrong


@dataclass(frozen=True, kw_only=True)
class PlateContact:
    """One loading of one plate."""

    plate: int
    """Index into the recording's plates."""
    start: float
    """Time [s] from the first stored frame."""
    end: float
    """Time [s] from the first stored frame."""
    side: Side | None
    """Foot whose outline holds the centre of pressure; None where there is none."""
    reason: str
    """Why the contact is rejected; empty when it is accepted."""

    @property
    def accepted(self) -> bool:
        """Whether the plate measured all of this foot's ground reaction and nothing else."""
        return not self.reason


def assign_contacts(recording: Recording, events: Sequence[Event]) -> tuple[PlateContact, ...]:
    """All contacts of all plates in time order, each with its foot or the reason why it is rejected.

    Args:
        recording: The trial, its plates and its heel and toe markers.
        events: Foot strikes and foot offs, to see whether a foot stood longer than its plate was loaded.

    Raises:
        InvalidRecording: A foot has neither heel nor toe markers.
    """
    if not recording.force_plates:
        return ()
    motions: dict[Side, FootMotion] = {side: foot_motion(recording, side, CUT_OFF) for side in SIDES}
    floor = min(float(plate.corners[:, 2].mean()) for plate in recording.force_plates)
    found: list[PlateContact] = []
    for index, plate in enumerate(recording.force_plates):
        on_plate = _OnPlate(recording, plate, motions, floor)
        loads = [(start / plate.rate, end / plate.rate) for start, end in contacts(plate)]
        found += [_judge(index, on_plate, start, end, events) for start, end in _stances(on_plate, loads)]
    return tuple(sorted(found, key=lambda contact: contact.start))


def contact_sentences(found: Sequence[PlateContact], name: str) -> tuple[str, ...]:
    """A sentence for each rejected contact of the trial called `name`."""
    return tuple(
        f"{name}: force plate {c.plate + 1}, {c.start:.2f}-{c.end:.2f} s"
        f"{'' if c.side is None else f', {c.side} foot'}: not used, {c.reason}"
        for c in found
        if not c.accepted
    )


def outline_share(centre: np.ndarray, load: np.ndarray, motion: FootMotion, frames: slice) -> float:
    """Share of the load [N], shape (n,), whose centre of pressure (n, 3) [m] lies inside the foot's outline.

    The outline is a rectangle about the line from heel to toe marker, wider than the foot by the markers' spread.
    """
    heel, toe = motion.heel[frames], motion.toe[frames]
    length = float(np.nanmedian(np.linalg.norm(motion.toe - motion.heel, axis=1)))
    along = (toe - heel)[:, :2]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    reach = (centre - toe)[:, :2]
    x = np.einsum("ij,ij->i", reach, along) / length
    y = (along[:, 0] * reach[:, 1] - along[:, 1] * reach[:, 0]) / length
    inside = (x > -1.0 - BEHIND) & (x < BEYOND) & (np.abs(y) < BESIDE)
    known = np.isfinite(x) & np.isfinite(y) & np.isfinite(load)
    total = float(load[known].sum())
    return float(load[known & inside].sum()) / total if total > 0.0 else 0.0


class _OnPlate:
    """One plate at video frames, and the feet seen from it."""

    def __init__(
        self, recording: Recording, plate: ForcePlate, motions: Mapping[Side, FootMotion], floor: float
    ) -> None:
        self.rate, self.n_frames, self.motions = recording.rate, recording.n_frames, motions
        at_frames = at_video_frames(plate, recording.rate, recording.n_frames)
        self.load = at_frames.force[:, 2]
        self.centre = centre_of_pressure(at_frames, LOADED)
        self.corners = plate.corners
        self.middle = plate.corners.mean(axis=0)
        self.raised = float(self.middle[2]) - floor > RAISED

    def frames(self, start: float, end: float) -> slice:
        """Frames of a contact."""
        return slice(int(np.ceil(start * self.rate)), min(int(end * self.rate) + 1, self.n_frames))

    def share(self, side: Side, frames: slice) -> float:
        """Share of the load inside the outline of one foot."""
        return outline_share(self.centre[frames], self.load[frames], self.motions[side], frames)

    def owner(self, start: float, end: float) -> Side | None:
        """The foot whose outline holds the centre of pressure between two times [s]; None where there is none."""
        frames = self.frames(start, end)
        shares = {side: self.share(side, frames) for side in SIDES}
        side = max(SIDES, key=lambda s: shares[s])
        return side if shares[side] >= FOREIGN else None

    def inside(self, points: np.ndarray) -> np.ndarray:
        """How far points (n, 3) [m] are inside the nearest edge [m], negative outside, shape (n,)."""
        distances: list[np.ndarray] = []
        for edge in (self.corners[0] - self.corners[1], self.corners[1] - self.corners[2]):
            half = float(np.linalg.norm(edge)) / 2
            distances.append(half - np.abs((points - self.middle) @ (edge / (2 * half))))
        return np.minimum(*distances)

    def stands_here(self, side: Side, frames: slice) -> bool:
        """Whether heel or toe of this foot stands on the plate during these frames."""
        motion = self.motions[side]
        ends = ((motion.heel, motion.heel_speed), (motion.toe, motion.toe_speed))
        on = [
            (speed[frames] < STANDING)
            & (self.inside(point[frames]) > 0.0)
            & (point[frames, 2] - self.middle[2] < LOW)
            & (self.load[frames] > LOADED)
            for point, speed in ends
        ]
        return max(int(end.sum()) for end in on) / self.rate > OTHER_FOOT

    def beside(self, side: Side, frames: slice) -> float:
        """How far heel or toe marker lie beside the plate while the whole foot stands [m]; 0 when they do not."""
        motion = self.motions[side]
        slow = (motion.heel_speed[frames] < STANDING) & (motion.toe_speed[frames] < STANDING)
        if not slow.any():
            return 0.0
        heel, toe = (self.inside(point[frames][slow]) for point in (motion.heel, motion.toe))
        return max(0.0, -float(np.median(np.minimum(heel, toe))))


def _stances(on_plate: _OnPlate, loads: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Loadings [s] of one plate; those that one foot makes with a pause shorter than any swing are one stance."""
    merged: list[tuple[float, float]] = []
    for start, end in loads:
        paused = bool(merged) and start - merged[-1][1] <= PAUSE
        if paused and on_plate.owner(*merged[-1]) == on_plate.owner(start, end) is not None:
            merged[-1] = (merged[-1][0], end)
        else:
            merged.append((start, end))
    return merged


def _judge(index: int, on_plate: _OnPlate, start: float, end: float, events: Sequence[Event]) -> PlateContact:
    side = on_plate.owner(start, end)
    if side is None:
        reason = "no foot is above its centre of pressure"
        return PlateContact(plate=index, start=start, end=end, side=None, reason=reason)
    reason = _reason(on_plate, side, on_plate.frames(start, end))
    if not reason and not _stance_fits(side, start, end, events):
        reason = "the foot stood longer than the plate was loaded, so it stood partly beside it"
    return PlateContact(plate=index, start=start, end=end, side=side, reason=reason)


def _reason(on_plate: _OnPlate, side: Side, frames: slice) -> str:
    other: Side = "right" if side == "left" else "left"
    if on_plate.stands_here(other, frames):
        return f"the {other} foot stood on it too"
    beside = on_plate.beside(side, frames)
    if beside > EDGE and not on_plate.raised:
        return f"the foot stood partly beside it ({100.0 * beside:.0f} cm)"
    share = on_plate.share(side, frames)
    if share < OWN:
        return f"its centre of pressure leaves the foot during {100.0 * (1.0 - share):.0f} % of the load"
    return ""


def _stance_fits(side: Side, start: float, end: float, events: Sequence[Event]) -> bool:
    """Whether the stance of this foot during the contact is no longer than the contact."""
    own = sorted((event for event in events if event.side == side), key=lambda event: event.time)
    middle = (start + end) / 2
    before = [event for event in own if event.time <= middle]
    after = [event for event in own if event.time > middle]
    early = bool(before) and before[-1].kind == "foot_strike" and before[-1].time < start - STANCE_TOLERANCE
    late = bool(after) and after[0].kind == "foot_off" and after[0].time > end + STANCE_TOLERANCE
    return not early and not late
