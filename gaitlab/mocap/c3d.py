"""C3D files: reading into a `Recording` (parsed in a child process) and writing. The only file that imports ezc3d."""

import hashlib
from pathlib import Path

import ezc3d
import numpy as np

from gaitlab.mocap.interpretation import interpret
from gaitlab.mocap.raw import ParameterValue, RawRecording
from gaitlab.mocap.recording import Recording
from gaitlab.mocap.sandbox import ReaderLimits, read_raw


def read_c3d(path: Path, limits: ReaderLimits | None = None) -> Recording:
    """The trial in a C3D file, in SI units.

    Args:
        path: C3D file.
        limits: Size, memory and time that reading may take.

    Raises:
        InvalidRecording: The file cannot be used; the message says why and what to do.
    """
    raw = read_raw(path, limits or ReaderLimits())
    return interpret(raw, name=path.stem, sha256=_sha256(path))


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def extract(path: Path) -> RawRecording:
    """Parses a C3D file in this process; only the child process and tests call it.

    A point is missing where its residual is negative or where it is 0 0 0, which Vicon writes for nothing.
    """
    c3d = ezc3d.c3d(str(path), extract_forceplat_data=False)
    header, data = c3d["header"], c3d["data"]
    points = np.moveaxis(np.asarray(data["points"][:3], dtype=float), (0, 1, 2), (2, 1, 0)).copy()  # (n, k, 3)
    residuals = np.asarray(data["meta_points"]["residuals"])[0].T  # (n, k)
    points[(residuals < 0) | (points == 0).all(axis=2)] = np.nan
    parameters = {
        group.upper(): {name.upper(): _value(entry["value"]) for name, entry in members.items() if name[:2] != "__"}
        for group, members in c3d["parameters"].items()
    }
    raw = RawRecording(
        labels=(),
        points=points,
        rate=float(header["points"]["frame_rate"]),
        first_frame=int(header["points"]["first_frame"]),
        analog=np.asarray(data["analogs"], dtype=float)[0].T.copy(),
        analog_rate=float(header["analogs"]["frame_rate"]),
        parameters=parameters,
    )
    labels = raw.numbered_texts("POINT", "LABELS")[: points.shape[1]]
    unnamed = ("",) * (points.shape[1] - len(labels))
    return RawRecording(**{**vars(raw), "labels": labels + unnamed})


def _value(value: "list[str] | np.ndarray") -> ParameterValue:
    if isinstance(value, np.ndarray):
        return value.astype(float)
    return tuple(text.encode("utf-8", "replace").decode().strip() for text in value)
