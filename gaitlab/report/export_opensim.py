"""Export to OpenSim: markers as .trc; coordinates of the model and ground reactions as .mot.

Axes of OpenSim: x forward, y up, z to the right. Forward is the walking direction, so the gait frame (x forward,
y left, z up) is turned about x: (x, z, -y). Unknown numbers are written as nan: OpenSim 4.6 takes an empty cell of a
.trc for what was there in the row before, or refuses it.
Formats: OpenSim documentation, "Marker (.trc) Files" and "Storage (.sto) Files".
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import OutputError
from .walk_file import Walk, read_walk

MILLIMETRES = 1e3
STRAY = 1e-3  # [m]; the pelvis lies on its coordinates to rounding


@dataclass(frozen=True, kw_only=True)
class MotionColumns:
    """A table over time, as a .mot file holds it."""

    name: str
    """First line of the file."""
    in_degrees: bool
    notes: Sequence[str]
    """Sentences for the header."""
    labels: Sequence[str]
    values: np.ndarray
    """One column per label, shape (n_frames, n_columns)."""


def export_trc(directory: Path, target: Path) -> None:
    """Writes the markers of one trial [mm], OpenSim's axes; a missing marker is nan.

    Raises:
        OutputError: walk.npz is absent or holds no markers, or the file cannot be written.
    """
    walk = read_walk(directory)
    markers, names = walk.vectors("markers"), walk.names("marker_names")
    if markers is None or len(names) != markers.shape[1]:
        raise OutputError(f"{directory / 'walk.npz'} holds no markers; run 'gaitlab analyse' again")
    positions = MILLIMETRES * to_opensim(markers, _heading(walk))
    rate, n = _rate(walk), len(walk.time)
    head = [
        f"PathFileType\t4\t(X/Y/Z)\t{target.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate:.6f}\t{rate:.6f}\t{n}\t{len(names)}\tmm\t{rate:.6f}\t1\t{n}",
        "Frame#\tTime\t" + "\t\t\t".join(names) + "\t\t",
        "\t\t" + "\t".join(f"{axis}{k}" for k in range(1, len(names) + 1) for axis in "XYZ"),
        "",
    ]
    rows = [
        f"{frame}\t{time:.6f}\t" + "\t".join(f"{x:.5f}" for x in row)
        for frame, (time, row) in enumerate(zip(walk.time, positions.reshape(n, -1), strict=True), 1)
    ]
    _write(target, [*head, *rows])


def export_coordinates(directory: Path, target: Path) -> None:
    """Writes the measured coordinates of the model in model.urdf: joints by its names, degrees, metres.

    They are not those of an OpenSim model; translations are x forward, y left, z up, as in the URDF.

    Raises:
        OutputError: walk.npz is absent or holds no coordinates, or the file cannot be written.
    """
    walk = read_walk(directory)
    q = walk.numbers("q_measured", 2)
    if q is None:
        raise OutputError(f"{directory / 'walk.npz'} holds no q_measured; run 'gaitlab analyse' again")
    names = coordinate_names(walk, q.shape[1])
    values = np.column_stack([q[:, :3], np.degrees(q[:, 3:])])
    notes = ("joints and signs of model.urdf; translations [m] x forward, y left, z up; rotations [deg] about y, x, z",)
    write_motion(
        target,
        walk.time,
        MotionColumns(name="Coordinates", in_degrees=True, notes=notes, labels=names, values=values),
    )


def export_ground_reactions(directory: Path, target: Path) -> None:
    """Writes force [N], centre of pressure [m] and free moment [N*m] of every plate, OpenSim's axes.

    A plate is not a foot: result.json lists which contacts belong to which foot. Zero where a plate carries less than
    20 N.

    Raises:
        OutputError: walk.npz is absent or holds no plates, or the file cannot be written.
    """
    walk = read_walk(directory)
    force, centre, twist = walk.vectors("grf_plates"), walk.vectors("cop_plates"), walk.numbers("free_moment_plates", 2)
    if force is None or centre is None or twist is None:
        raise OutputError(
            f"{directory / 'walk.npz'} holds no force plates with free moments; the files have none, or "
            "an older version wrote it: run 'gaitlab analyse' again"
        )
    heading = _heading(walk)
    loaded = np.isfinite(centre).all(axis=2) & np.isfinite(twist)
    torque = np.zeros_like(force)
    torque[:, :, 2] = np.where(loaded, twist, 0.0)  # about the vertical: plates lie level
    parts = [to_opensim(np.where(loaded[:, :, None], v, 0.0), heading) for v in (force, centre, torque)]
    labels = [
        f"ground_{kind}_{plate + 1}_{letter}{axis}"
        for plate in range(force.shape[1])
        for kind, letter in (("force", "v"), ("force", "p"), ("moment", "m"))
        for axis in "xyz"
    ]
    values = np.concatenate(parts, axis=2).reshape(len(walk.time), -1)
    notes = ("force on the foot [N], point [m], free moment [N*m] of each plate; x forward, y up, z right",)
    motion = MotionColumns(name="ground_reactions", in_degrees=False, notes=notes, labels=labels, values=values)
    write_motion(target, walk.time, motion)


def to_opensim(vectors: np.ndarray, heading: float) -> np.ndarray:
    """Points or vectors, any unit, shape (..., 3), from the laboratory (z up) to OpenSim's axes; `heading` [rad]."""
    c, s = np.cos(heading), np.sin(heading)
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return np.stack([c * x + s * y, z, s * x - c * y], axis=-1)


def write_motion(target: Path, time: np.ndarray, motion: MotionColumns) -> None:
    """Writes a .mot file; `time` [s], shape (n_frames,).

    Raises:
        OutputError: The file cannot be written.
    """
    head = [
        motion.name,
        "version=1",
        f"nRows={len(time)}",
        f"nColumns={1 + len(motion.labels)}",
        f"inDegrees={'yes' if motion.in_degrees else 'no'}",
        *motion.notes,
        "endheader",
        "\t".join(["time", *motion.labels]),
    ]
    rows = [
        f"{moment:.6f}\t" + "\t".join(f"{x:.8g}" for x in row) for moment, row in zip(time, motion.values, strict=True)
    ]
    _write(target, [*head, *rows])


def coordinate_names(walk: Walk, n_q: int) -> list[str]:
    """Names of the coordinates as the joints of model.urdf are called: pelvis_tx ..., pelvis_y, right_thigh_y ..."""
    segments = walk.names("segment_names")[: n_q // 3 - 1]
    if len(segments) != n_q // 3 - 1:
        raise OutputError(f"walk.npz names {len(segments)} segments for {n_q} coordinates; run 'gaitlab analyse' again")
    turns = [f"{segment}_{axis}" for segment in segments for axis in "yxz"]
    return [*(f"{segments[0]}_t{axis}" for axis in "xyz"), *turns]


def _heading(walk: Walk) -> float:
    """Direction of the gait frame in the laboratory [rad]: it turns the model's pelvis onto the measured one."""
    q, positions = walk.numbers("q_measured", 2), walk.vectors("segment_positions_measured")
    if q is None or positions is None or not np.isfinite(q).any():
        raise OutputError("walk.npz has no measured coordinates and positions; run 'gaitlab analyse' again")
    known = np.isfinite(q[:, :2]).all(axis=1)
    gait, laboratory = q[known, :2], positions[known, 0, :2]
    cross = float(np.sum(gait[:, 0] * laboratory[:, 1] - gait[:, 1] * laboratory[:, 0]))
    heading = float(np.arctan2(cross, np.sum(gait * laboratory)))
    c, s = np.cos(heading), np.sin(heading)
    if np.abs(gait @ np.array([[c, s], [-s, c]]) - laboratory).max() > STRAY:
        raise OutputError("walk.npz: coordinates and positions of the pelvis do not belong together")
    return heading


def _rate(walk: Walk) -> float:
    return (len(walk.time) - 1) / float(walk.time[-1] - walk.time[0]) if len(walk.time) > 1 else 1.0


def _write(target: Path, lines: Sequence[str]) -> None:
    try:
        target.write_text("\n".join(lines) + "\n", encoding="utf-8")
    except OSError as error:
        raise OutputError(f"{target} cannot be written ({error.strerror}): choose another folder") from error
