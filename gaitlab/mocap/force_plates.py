"""Force plates of C3D types 1 to 4: what the ground does to the foot, about the centre of the working surface.

Source: C3D file format, the FORCE_PLATFORM group (c3d.org). Plate axes: x and y in the surface, z down, corners
numbered from the +x +y quadrant: x = (c0 + c3 - c1 - c2), y = (c0 + c1 - c2 - c3), z = x cross y.
"""

from collections.abc import Callable

import numpy as np

from gaitlab.mocap.raw import RawRecording
from gaitlab.mocap.recording import ForcePlate
from gaitlab.signal.averaging import centred_means

MILLIMETRES = 1e3  # per metre
LOADED = 100.0  # N; a plate under a foot carries more, unloaded plates drift by less
Wrench = tuple[np.ndarray, np.ndarray]
"""Force [N] and moment [N*m] in plate axes, shapes (n_samples, 3), about the centre of the working surface."""


def force_plates(
    raw: RawRecording, metre: float, rotation: np.ndarray
) -> tuple[tuple[ForcePlate, ...], tuple[str, ...]]:
    """All plates of the file that can be used, and warnings about the others.

    Args:
        raw: Contents of the file.
        metre: Metres per unit of the file's lengths.
        rotation: From the file's axes to z up, shape (3, 3).
    """
    types = raw.numbers("FORCE_PLATFORM", "TYPE")
    plates: list[ForcePlate] = []
    warnings: list[str] = []
    for k in range(min(types.size, _used(raw))):
        try:
            plate, said = _plate(raw, k, int(types.flat[k]), metre, rotation)
        except ValueError as error:
            warnings.append(f"force plate {k + 1} is not used: {error}")
            continue
        plates.append(plate)
        warnings.extend(f"force plate {k + 1}: {sentence}" for sentence in said)
    return tuple(plates), tuple(warnings)


def plate_channels(raw: RawRecording) -> frozenset[int]:
    """Columns of the analogue data that belong to plates."""
    channels = raw.numbers("FORCE_PLATFORM", "CHANNEL")
    return frozenset(int(channel) - 1 for channel in channels.ravel() if channel > 0)


def _used(raw: RawRecording) -> int:
    used = raw.numbers("FORCE_PLATFORM", "USED")
    return int(used.flat[0]) if used.size and np.isfinite(used.flat[0]) else 0


def _plate(raw: RawRecording, k: int, kind: int, metre: float, z_up: np.ndarray) -> tuple[ForcePlate, tuple[str, ...]]:
    if kind not in TYPES:
        raise ValueError(f"its type is {kind}, gaitlab knows types 1 to 4")
    n_channels, wrench_of = TYPES[kind]
    corners = _of_plate(raw, "CORNERS", k, 12).reshape(4, 3) @ (metre * z_up.T)
    origin = _of_plate(raw, "ORIGIN", k, 3) * metre
    rotation = _rotation(corners)
    samples = _samples(raw, k, kind, metre)
    force, moment = (vectors @ rotation.T for vectors in wrench_of(samples[:, :n_channels], origin))
    down, up = -force[:, 2].min(initial=0.0), force[:, 2].max(initial=0.0)
    if down > max(LOADED, 3.0 * up):
        said = ("the file stores the force on the plate; its sign is changed to the force on the foot",)
        return ForcePlate(corners=corners, force=-force, moment=-moment, rate=raw.analog_rate), said
    return ForcePlate(corners=corners, force=force, moment=moment, rate=raw.analog_rate), ()


def _of_plate(raw: RawRecording, name: str, k: int, size: int) -> np.ndarray:
    """First `size` numbers of a FORCE_PLATFORM parameter for plate k, in the file's order."""
    value = raw.numbers("FORCE_PLATFORM", name)
    n_plates = value.shape[-1] if value.ndim == PLATE_DIMENSIONS[name] else 1
    per_plate = value.size // max(n_plates, 1)
    chosen = value.ravel(order="F")[k * per_plate : k * per_plate + size]
    if chosen.size < size:
        raise ValueError(f"FORCE_PLATFORM:{name} is missing or too short")
    return chosen


def _samples(raw: RawRecording, k: int, kind: int, metre: float) -> np.ndarray:
    """Channels of plate k without their zero offset, in N, N*m and m, shape (n_samples, n_channels)."""
    channels = _of_plate(raw, "CHANNEL", k, TYPES[kind][0]).astype(int) - 1
    if channels.min() < 0 or channels.max() >= raw.analog.shape[1]:
        raise ValueError("its channels are not in the file")
    samples = raw.analog[:, channels]
    samples = samples - _zero(raw, samples)
    if kind == 4:
        matrix = _of_plate(raw, "CAL_MATRIX", k, 36).reshape(6, 6, order="F")
        return (samples @ matrix.T) * np.array([1.0, 1.0, 1.0, metre, metre, metre])
    units = raw.numbered_texts("ANALOG", "UNITS")
    stated = [units[c] if c < len(units) else "" for c in channels]
    return samples * np.array([_unit(unit, column, kind, metre) for column, unit in enumerate(stated)])


def _zero(raw: RawRecording, samples: np.ndarray) -> np.ndarray:
    """Mean over the video frames FORCE_PLATFORM:ZERO = (first, last), counted from 1; 0 when there is no such range."""
    zero = raw.numbers("FORCE_PLATFORM", "ZERO").ravel()
    n_frames = raw.points.shape[0]
    if zero.size < 2 or not 1 <= zero[0] <= zero[1] <= n_frames:
        return np.zeros(samples.shape[1])
    per_frame = samples.shape[0] // n_frames
    return samples[int(zero[0] - 1) * per_frame : int(zero[1]) * per_frame].mean(axis=0)


def _unit(stated: str, column: int, kind: int, metre: float) -> float:
    """SI value of one unit of a channel. What is not stated is in N, in the file's length unit, or in their product."""
    letters = "".join(c for c in stated if c.isalpha()).lower()
    is_force = column < 3 or kind == 3
    if is_force:
        return FORCE_UNITS.get(letters, 1.0)
    is_position = kind == 1 and column in (3, 4)
    return (POSITION_UNITS if is_position else MOMENT_UNITS).get(letters, metre)


def _rotation(corners: np.ndarray) -> np.ndarray:
    """Plate axes as columns in the laboratory frame, shape (3, 3)."""
    x = corners[0] + corners[3] - corners[1] - corners[2]
    y = corners[0] + corners[1] - corners[2] - corners[3]
    z = np.cross(x, y)
    if not np.linalg.norm(z) > 1e-6:
        raise ValueError("its corners do not span a rectangle")
    x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
    return np.column_stack([x, np.cross(z, x), z])


def _type_1(samples: np.ndarray, origin: np.ndarray) -> Wrench:
    """Channels Fx Fy Fz Px Py Tz: force, its point of application in plate axes, free moment about z."""
    force = samples[:, :3]
    lever = np.column_stack([samples[:, 3:5], np.zeros(len(samples))]) - origin * [1.0, 1.0, 0.0]
    free = np.column_stack([np.zeros((len(samples), 2)), samples[:, 5]])
    return force, np.cross(lever, force) + free


def _type_2(samples: np.ndarray, origin: np.ndarray) -> Wrench:
    """Channels Fx Fy Fz Mx My Mz about the transducer's origin; M_surface = M - o x F, o from origin to surface.

    z points down, so o_z < 0; where a file states the opposite vector (Vicon does), it is turned round.
    """
    o = -origin if origin[2] > 0 else origin
    force = samples[:, :3]
    return force, samples[:, 3:] - np.cross(o, force)


def _type_3(samples: np.ndarray, origin: np.ndarray) -> Wrench:
    """Channels Fx12 Fx34 Fy14 Fy23 Fz1 Fz2 Fz3 Fz4 of four sensors at (+-a, +-b); ORIGIN = (a, b, -depth)."""
    x12, x34, y14, y23, z1, z2, z3, z4 = samples.T
    a, b = np.abs(origin[:2])
    force = np.column_stack([x12 + x34, y14 + y23, z1 + z2 + z3 + z4])
    moment = np.column_stack([b * (z1 + z2 - z3 - z4), a * (-z1 + z2 + z3 - z4), b * (-x12 + x34) + a * (y14 - y23)])
    o = np.array([0.0, 0.0, -abs(origin[2])])
    return force, moment - np.cross(o, force)


TYPES: dict[int, tuple[int, Callable[[np.ndarray, np.ndarray], Wrench]]] = {
    1: (6, _type_1),
    2: (6, _type_2),
    3: (8, _type_3),
    4: (6, _type_2),  # type 2 through a calibration matrix
}
PLATE_DIMENSIONS = {"CORNERS": 3, "ORIGIN": 2, "CHANNEL": 2, "CAL_MATRIX": 3}
FORCE_UNITS = {"n": 1.0, "kn": 1e3}
POSITION_UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
MOMENT_UNITS = {"nmm": 1e-3, "ncm": 1e-2, "nm": 1.0, "knm": 1e3}


def centre_of_pressure(plate: ForcePlate, smallest: float = 20.0) -> np.ndarray:
    """Point of the working surface where the force acts, laboratory frame [m], shape (n_samples, 3).

    In plate axes p = (-M_y / F_z, M_x / F_z, 0) from the centre. NaN where |F_z| < `smallest` [N].
    """
    rotation = _rotation(plate.corners)
    force, moment = plate.force @ rotation, plate.moment @ rotation
    fz = np.where(np.abs(force[:, 2]) >= smallest, force[:, 2], np.nan)
    local = np.column_stack([-moment[:, 1] / fz, moment[:, 0] / fz, np.zeros(len(fz))])
    return plate.corners.mean(axis=0) + local @ rotation.T


def free_moment(plate: ForcePlate, centre: np.ndarray) -> np.ndarray:
    """Moment about the plate's upward normal n at the centre of pressure p [N*m], shape (n_samples,).

    T = n . (M_c - (p - c) x F) with the middle c of the surface; `centre` is p [m], shape (n_samples, 3), and T is NaN
    where p is.
    """
    normal = np.cross(plate.corners[1] - plate.corners[0], plate.corners[3] - plate.corners[0])
    normal = normal / np.linalg.norm(normal) * (1.0 if normal[2] >= 0.0 else -1.0)
    return (plate.moment - np.cross(centre - plate.corners.mean(axis=0), plate.force)) @ normal


def at_video_frames(plate: ForcePlate, rate: float, n_frames: int) -> ForcePlate:
    """The plate with one sample per video frame: the centred mean of the samples around it.

    Args:
        plate: The plate at its own rate.
        rate: Video frames per second [Hz].
        n_frames: Number of video frames.
    """
    ratio = max(int(round(plate.rate / rate)), 1)
    force = centred_means(plate.force, ratio)[:n_frames]
    moment = centred_means(plate.moment, ratio)[:n_frames]
    return ForcePlate(corners=plate.corners, force=force, moment=moment, rate=rate)


def plate_samples(plate: ForcePlate) -> np.ndarray:
    """Channels Fx Fy Fz [N] Mx My Mz [N*mm] of a type 2 plate with its origin in the surface, shape (n_samples, 6)."""
    rotation = _rotation(plate.corners)
    return np.hstack([plate.force @ rotation, MILLIMETRES * plate.moment @ rotation])
