"""From a simulated walk to what a laboratory would have recorded: markers, force plates, events."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..mocap.recording import Event, ForcePlate, Recording, SoleChange
from ..multibody.kinematics import point_positions
from ..multibody.subject import SubjectModel

RATE, PLATE_RATE = 100.0, 1000.0  # [Hz]
STATIC_FRAMES = 100
PLATE_LENGTH, PLATE_WIDTH = 0.44, 0.50  # [m], along and across the walk
RESOLUTION = 1e-5  # [m], of marker positions as written
FORCE_RESOLUTION = 0.01  # [N] and [N*m]


@dataclass(frozen=True, kw_only=True)
class SimulatedWalk:
    """A walk of a subject with markers, gait frame, time 0 at the first frame."""

    subject: SubjectModel
    q: np.ndarray
    """Coordinates at `RATE` [m, rad], shape (n, n_q)."""
    dense_q: np.ndarray
    """Coordinates at `PLATE_RATE` up to the last frame [m, rad], shape (10 n - 9, n_q)."""
    forces: Mapping[str, np.ndarray]
    """Contact point to the force of the floor on it at `PLATE_RATE` [N], shape (10 n - 9, 3)."""
    events: tuple[Event, ...]
    sole_changes: tuple[SoleChange, ...]


@dataclass(frozen=True, kw_only=True)
class Laboratory:
    """Where and how precisely a walk is recorded."""

    heading: float = 0.0
    """Direction of the walk about the vertical [rad]."""
    noise: float = 0.0
    """Standard deviation of each marker coordinate [m]."""
    seed: int = 0


def walk_recording(
    name: str, walk: SimulatedWalk, parameters: Mapping[str, float], laboratory: Laboratory
) -> Recording:
    """The trial with markers at 100 Hz, two force plates at 1000 Hz and the true events."""
    gait = point_positions(walk.subject, walk.subject.markers, walk.q)
    middle = np.median(walk.q[:, 0])
    return Recording(
        name=name,
        sha256="",
        rate=RATE,
        first_frame=0,
        markers=_measured(gait, laboratory, middle),
        force_plates=_plates(walk, laboratory, middle),
        events=walk.events,
        sole_changes=walk.sole_changes,
        parameters=parameters,
    )


def static_recording(subject: SubjectModel, q: np.ndarray, parameters: Mapping[str, float]) -> Recording:
    """One second of standing still at coordinates q (n_q,) [m, rad]."""
    gait = point_positions(subject, subject.markers, np.repeat(q[None], STATIC_FRAMES, axis=0))
    return Recording(
        name="static",
        sha256="",
        rate=RATE,
        first_frame=0,
        markers=_measured(gait, Laboratory(), 0.0),
        parameters=parameters,
    )


def _turn(heading: float) -> np.ndarray:
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _measured(gait: Mapping[str, np.ndarray], laboratory: Laboratory, middle: float) -> dict[str, np.ndarray]:
    """Markers in the laboratory, whose origin lies in the middle of the walk, rounded to what is written [m]."""
    random = np.random.default_rng(laboratory.seed)
    R, markers = _turn(laboratory.heading), dict[str, np.ndarray]()
    for name, positions in gait.items():
        moved = (positions - [middle, 0.0, 0.0]) @ R.T + laboratory.noise * random.standard_normal(positions.shape)
        markers[name] = RESOLUTION * np.round(moved / RESOLUTION)
    return markers


def _plates(walk: SimulatedWalk, laboratory: Laboratory, middle: float) -> tuple[ForcePlate, ...]:
    """A plate under the first foot that strikes near the middle of the walk, and one under the next foot."""
    points = point_positions(walk.subject, {n: walk.subject.contacts[n] for n in walk.forces}, walk.dense_q)
    plates: list[ForcePlate] = []
    for centre in _plate_centres(walk, points):
        force, moment = np.zeros((len(walk.dense_q), 3)), np.zeros((len(walk.dense_q), 3))
        for name, contact in walk.forces.items():
            lever = points[name] - [centre, 0.0, 0.0]
            inside = np.all(np.abs(lever[:, :2]) < np.array([PLATE_LENGTH / 2, PLATE_WIDTH / 2]), axis=1)
            applied = np.where(inside[:, None], contact, 0.0)
            force += applied
            moment += np.cross(lever * [1.0, 1.0, 0.0], applied)
        plates.append(_plate(np.array([centre - middle, 0.0, 0.0]), force, moment, _turn(laboratory.heading)))
    return tuple(plates)


def _plate_centres(walk: SimulatedWalk, points: Mapping[str, np.ndarray]) -> list[float]:
    """Where the right foot and then the left foot stand in the middle of the trial [m]."""
    strikes = {
        side: [e.time for e in walk.events if e.side == side and e.kind == "foot_strike"] for side in ("right", "left")
    }
    offs = {
        side: [e.time for e in walk.events if e.side == side and e.kind == "foot_off"] for side in ("right", "left")
    }
    half = len(walk.dense_q) / PLATE_RATE / 2
    right = next(t for t in strikes["right"] if any(t < off for off in offs["right"]) and t > half / 4)
    left = next(t for t in strikes["left"] if t > right)
    centres: list[float] = []
    for side, strike in (("right", right), ("left", left)):
        off = next(t for t in offs[side] if t > strike)
        at = round((strike + off) / 2 * PLATE_RATE)
        centres.append(float((points[f"{side}_heel"][at, 0] + points[f"{side}_toe"][at, 0]) / 2))
    return centres


def _plate(centre: np.ndarray, force: np.ndarray, moment: np.ndarray, R: np.ndarray) -> ForcePlate:
    half = np.array([[1, -1, 0], [-1, -1, 0], [-1, 1, 0], [1, 1, 0]]) * [PLATE_LENGTH / 2, PLATE_WIDTH / 2, 0.0]
    return ForcePlate(
        corners=(centre + half) @ R.T,
        force=_as_written(force @ R.T),
        moment=_as_written(moment @ R.T),
        rate=PLATE_RATE,
    )


def _as_written(samples: np.ndarray) -> np.ndarray:
    """Rounded, and the last sample repeated up to the end of the last video frame, shape (10 n, 3)."""
    held = np.repeat(samples[-1:], round(PLATE_RATE / RATE) - 1, axis=0)
    return FORCE_RESOLUTION * np.round(np.concatenate([samples, held]) / FORCE_RESOLUTION)
