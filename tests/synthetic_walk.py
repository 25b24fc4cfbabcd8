"""A walk whose gait events are known exactly, and C3D files in the variants that the real recordings lack."""

from dataclasses import dataclass, replace
from pathlib import Path

import ezc3d
import numpy as np

from gaitlab.mocap.c3d import write_c3d
from gaitlab.mocap.recording import Event, ForcePlate, Recording

RATE = 100.0
FOOT = 0.18  # m, heel marker to toe marker


@dataclass(frozen=True, kw_only=True)
class Gait:
    """How the synthetic person walks. Lengths m, times s, speed m/s, heading rad."""

    speed: float = 1.2
    stride_time: float = 1.1
    stance: float = 0.62
    heading: float = 0.0
    toe_first: bool = False
    duration: float = 4.0
    origin: tuple[float, float] = (-2.0, 0.3)


def synthetic_walk(gait: Gait = Gait()) -> Recording:
    """A walking trial with all lower-body markers, laboratory frame, m; its events are the exact ones, source file."""
    t = np.arange(round(gait.duration * RATE)) / RATE
    strikes = {"left": 0.15, "right": 0.15 + 0.5 * gait.stride_time}
    markers: dict[str, np.ndarray] = {}
    for side, y in (("left", 0.09), ("right", -0.09)):
        heel, toe = _foot(t, strikes[side], y, gait)
        letter = side[0].upper()
        pelvis = np.column_stack([gait.speed * t + 0.1, np.full_like(t, 1.3 * y), np.full_like(t, 0.95)])
        ankle = 0.6 * heel + 0.4 * toe + [0.0, 0.0, 0.05]
        markers |= {letter + "HEE": heel, letter + "TOE": toe, letter + "ANK": ankle, letter + "ASI": pelvis}
        markers |= {
            letter + name: ankle + s * (pelvis - ankle) for name, s in (("TIB", 0.25), ("KNE", 0.5), ("THI", 0.7))
        }
        markers[letter + "PSI"] = pelvis - [0.18, 0.0, 0.0]
    events = [event for side in ("left", "right") for event in _events(side, strikes[side], gait)]
    c, s = np.cos(gait.heading), np.sin(gait.heading)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return Recording(
        name="synthetic",
        sha256="",
        rate=RATE,
        first_frame=37,
        markers={name: x @ turn.T + [*gait.origin, 0.0] for name, x in markers.items()},
        events=tuple(sorted(events, key=lambda event: event.time)),
        parameters={"mass": 30.0, "height": 1.3, "left_leg_length": 0.7, "right_leg_length": 0.7},
    )


def _events(side: str, strike: float, gait: Gait) -> list[Event]:
    found: list[Event] = []
    for k in range(-1, int(gait.duration / gait.stride_time) + 1):
        for kind, time in (("foot_strike", strike), ("foot_off", strike + gait.stance * gait.stride_time)):
            shifted = time + k * gait.stride_time
            if 0.0 <= shifted <= gait.duration - 1.0 / RATE:
                found.append(Event(side=side, kind=kind, time=shifted, source="file"))
    return found


def _foot(t: np.ndarray, strike: float, y: float, gait: Gait) -> tuple[np.ndarray, np.ndarray]:
    """Heel and toe: pitched about the point that stands (heel, then toe), half-sine speed profile in swing."""
    cycle = (t - strike) / gait.stride_time
    k, phase = np.floor(cycle), cycle % 1.0
    here = gait.speed * (strike + gait.stride_time * k)  # heel position in stance k
    heel, toe = _stance(phase / gait.stance, here, y, gait.toe_first)
    s = np.clip((phase - gait.stance) / (1.0 - gait.stance), 0.0, 1.0)
    share = (1.0 - np.cos(np.pi * s))[:, None] / 2.0
    lift = 0.06 * np.sin(np.pi * s)[:, None] ** 2 * [0.0, 0.0, 1.0]
    left, reached = np.ones_like(t), np.zeros_like(t)
    from_heel, from_toe = _stance(left, here, y, gait.toe_first)
    to_heel, to_toe = _stance(reached, here + gait.speed * gait.stride_time, y, gait.toe_first)
    swing = (phase > gait.stance)[:, None]
    heel = np.where(swing, from_heel + share * (to_heel - from_heel) + lift, heel)
    toe = np.where(swing, from_toe + share * (to_toe - from_toe) + lift, toe)
    return heel, toe


def _stance(share: np.ndarray, heel_x: np.ndarray, y: float, toe_first: bool) -> tuple[np.ndarray, np.ndarray]:
    """Heel and toe at the given share of stance: lands pitched by 0.3 rad, flat from 15 %, rises to 0.8 rad."""
    landing = 0.3 * np.clip(1.0 - share / 0.15, 0.0, 1.0)
    rise = 0.8 * np.clip((share - 0.6) / 0.4, 0.0, 1.0) ** 2
    about_toe = rise + (landing if toe_first else 0.0)
    about_heel = 0.0 * landing if toe_first else landing
    toe_x = heel_x + FOOT * np.cos(about_heel)
    toe = np.column_stack([toe_x, np.full_like(share, y), 0.03 + FOOT * np.sin(about_heel)])
    heel_height = 0.03 + FOOT * np.sin(about_toe)
    back = np.where(about_toe > 0.0, heel_x + FOOT * (1.0 - np.cos(about_toe)), heel_x)
    return np.column_stack([back, np.full_like(share, y), heel_height]), toe


def rectangle(x: float, y: float, z: float = 0.0, length: float = 0.5, width: float = 0.4) -> np.ndarray:
    """Corners of a plate with its x axis along laboratory x and z down, in the C3D order, m, shape (4, 3)."""
    half = np.array([[1, -1], [-1, -1], [-1, 1], [1, 1]]) * [length / 2, width / 2]
    return np.column_stack([half + [x, y], np.full(4, z)])


def with_plate(recording: Recording, start: float, end: float, corners: np.ndarray) -> Recording:
    """The recording with a plate that carries 300 N between two times [s]."""
    rate = 10.0 * recording.rate
    t = np.arange(10 * recording.n_frames) / rate
    force = np.zeros((len(t), 3))
    force[(t >= start) & (t < end), 2] = 300.0
    plate = ForcePlate(corners=corners, force=force, moment=np.zeros_like(force), rate=rate)
    return replace(recording, force_plates=(*recording.force_plates, plate))


def write_variant(path: Path, recording: Recording, change) -> Path:
    """Writes the recording, lets `change(c3d)` alter the parsed file, and writes it again."""
    write_c3d(path, recording)
    c3d = ezc3d.c3d(str(path))
    change(c3d)
    c3d.write(str(path))
    return path
