"""The arrays of `walk.npz` that need no optimisation: markers, measured skeleton, plates, phases."""

from collections.abc import Sequence

import numpy as np

from ..mocap.force_plates import at_video_frames, centre_of_pressure, free_moment
from ..mocap.recording import Event, ForcePlate, Recording, Side
from ..multibody.kinematics import forward_kinematics, point_positions
from ..multibody.subject import SubjectModel
from .gait_frame import gait_to_lab

LOADED = 20.0  # [N]; below this the centre of pressure is noise
TIPS = ("right_toe", "left_toe")
PHASES = {
    (True, True): "double support",
    (True, False): "left support",
    (False, True): "right support",
    (False, False): "flight",
}
"""(left foot stands, right foot stands) to the name of the phase."""


def measured_arrays(
    recording: Recording, events: Sequence[Event], subject: SubjectModel, q: np.ndarray, heading: float
) -> dict[str, np.ndarray]:
    """Arrays with one row per stored frame, laboratory frame, SI units, NaN where unknown, and their names.

    Args:
        recording: The trial.
        events: Its events.
        subject: The person's model.
        q: Measured coordinates, gait frame [m, rad], shape (n_frames, n_q).
        heading: Direction of the gait frame's x axis in the laboratory [rad].
    """
    n = recording.n_frames
    names = sorted(recording.markers)
    plates = [plate_at_frames(plate, recording.rate, n) for plate in recording.force_plates]
    twists = [_free_moment(plate, recording.rate, n) for plate in recording.force_plates]
    time = np.arange(n) / recording.rate
    return {
        "time": time,
        "q_measured": q,
        "markers": np.stack([recording.markers[name] for name in names], axis=1),
        "marker_names": np.array(names),
        "segment_names": np.array([segment.name for segment in subject.segments] + list(TIPS)),
        "segment_positions_measured": skeleton(subject, q, heading),
        "centre_of_mass_measured": centre_of_mass(subject, q, heading),
        "bones": bones(subject),
        "contact_names": np.array(list(subject.contacts)),
        "phase": support_phases(events, time),
        "grf_plates": np.stack([force for force, _ in plates], axis=1) if plates else np.zeros((n, 0, 3)),
        "cop_plates": np.stack([centre for _, centre in plates], axis=1) if plates else np.zeros((n, 0, 3)),
        "free_moment_plates": np.stack(twists, axis=1) if twists else np.zeros((n, 0)),
    }


def skeleton(subject: SubjectModel, q: np.ndarray, heading: float) -> np.ndarray:
    """Origins of all segments, then the tips of the feet, laboratory frame [m], shape (n, n_segments + 2, 3).

    `q` are coordinates in the gait frame [m, rad], shape (n, n_q), `heading` its direction in the laboratory [rad].
    """
    origins = forward_kinematics(subject, q).origins
    contacts = point_positions(subject, subject.contacts, q)
    tips = np.stack([contacts[name] for name in TIPS], axis=1)
    return gait_to_lab(np.concatenate([origins, tips], axis=1), heading)


def centre_of_mass(subject: SubjectModel, q: np.ndarray, heading: float) -> np.ndarray:
    """Of the whole body, sum m_i c_i / sum m_i over its segments, laboratory frame [m], shape (n, 3).

    `q` are coordinates in the gait frame [m, rad], shape (n, n_q), `heading` its direction in the laboratory [rad].
    """
    poses = forward_kinematics(subject, q)
    local = np.array([segment.centre_of_mass for segment in subject.segments])
    mass = np.array([segment.mass for segment in subject.segments])
    centres = poses.origins + np.einsum("nsij,sj->nsi", poses.rotations, local)
    return gait_to_lab(np.einsum("s,nsi->ni", mass, centres) / mass.sum(), heading)


def bones(subject: SubjectModel) -> np.ndarray:
    """Pairs of rows of `skeleton` that a bone joins, whole numbers, shape (n_bones, 2)."""
    n = len(subject.segments)
    joints = [(segment.parent, index) for index, segment in enumerate(subject.segments) if segment.parent >= 0]
    feet = [(subject.contacts[name].segment, n + number) for number, name in enumerate(TIPS)]
    return np.array(joints + feet)


def support_phases(events: Sequence[Event], time: np.ndarray) -> np.ndarray:
    """Name of the phase at each time [s], shape (n,); empty where a side has no event at all."""
    left, right = (_stands(events, side, time) for side in ("left", "right"))
    if left is None or right is None:
        return np.full(len(time), "", dtype="<U16")
    return np.array([PHASES[bool(a), bool(b)] for a, b in zip(left, right, strict=True)], dtype="<U16")


def _stands(events: Sequence[Event], side: Side, time: np.ndarray) -> np.ndarray | None:
    own = sorted((event for event in events if event.side == side), key=lambda event: event.time)
    if not own:
        return None
    stands = [own[0].kind == "foot_off", *(event.kind == "foot_strike" for event in own)]
    return np.array(stands)[np.searchsorted([event.time for event in own], time, side="right")]


def plate_at_frames(plate: ForcePlate, rate: float, n_frames: int) -> tuple[np.ndarray, np.ndarray]:
    """Force [N] and centre of pressure [m] at video frames, laboratory frame, shape (n_frames, 3) each.

    Both come from centred means of the analogue samples of one frame (a one-sided mean would shift them in time). The
    centre is n x M / (n . F) from the middle of the surface with normal n; NaN below 20 N.
    """
    force, moment = (centred_means(samples, plate.rate / rate, n_frames) for samples in (plate.force, plate.moment))
    normal = np.cross(plate.corners[1] - plate.corners[0], plate.corners[3] - plate.corners[0])
    length = np.linalg.norm(normal)
    normal = normal / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    pressing = force @ normal
    loaded = np.abs(pressing) > LOADED
    arm = np.cross(normal, moment) / np.where(loaded, pressing, np.nan)[:, None]
    return force, plate.corners.mean(axis=0) + arm


def _free_moment(plate: ForcePlate, rate: float, n_frames: int) -> np.ndarray:
    """About the plate's normal at the centre of pressure [N*m], shape (n_frames,); NaN below 20 N."""
    at_frames = at_video_frames(plate, rate, n_frames)
    values = free_moment(at_frames, centre_of_pressure(at_frames, LOADED))
    return np.concatenate([values, np.full(n_frames - len(values), np.nan)])


def centred_means(samples: np.ndarray, per_frame: float, n_frames: int) -> np.ndarray:
    """Means of samples (n_samples, 3), any unit, over one frame centred at each of the video frames: (n_frames, 3)."""
    total = np.concatenate([np.zeros((1, samples.shape[1])), np.cumsum(samples, axis=0)])
    centres = np.arange(n_frames) * per_frame
    start = np.clip(np.ceil(centres - 0.5 * per_frame), 0, len(samples)).astype(int)
    end = np.clip(np.floor(centres + 0.5 * per_frame) + 1, 0, len(samples)).astype(int)
    count = np.maximum(end - start, 0)[:, None]
    return np.where(count > 0, (total[end] - total[start]) / np.maximum(count, 1), np.nan)
