"""C3D files: reading into a `Recording` (parsed in a child process) and writing. The only file that imports ezc3d."""

import hashlib
from pathlib import Path

import ezc3d
import numpy as np

from gaitlab.errors import OutputError
from gaitlab.mocap.force_plates import MILLIMETRES, plate_samples
from gaitlab.mocap.interpretation import interpret
from gaitlab.mocap.raw import ParameterValue, RawRecording
from gaitlab.mocap.recording import Recording
from gaitlab.mocap.sandbox import ReaderLimits, read_raw
from gaitlab.mocap.subject_parameters import file_parameters

EVENT_LABELS = {
    "foot_strike": "Foot Strike",
    "foot_off": "Foot Off",
    "foot_flat": "Foot Flat",
    "heel_off": "Heel Off",
}


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
    points[(residuals < 0) | (points == 0).all(axis=2) | ~np.isfinite(points).all(axis=2)] = np.nan
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


def write_c3d(path: Path, recording: Recording) -> None:
    """Writes markers, plates (type 2), events and subject parameters in mm, N and N*mm, as Nexus would.

    Model outputs and other analogue channels are not written. Numbers are stored as 32-bit reals; the same recording
    gives the same bytes.

    Raises:
        OutputError: The file cannot be written.
    """
    c3d = ezc3d.c3d()
    _put_points(c3d, recording)
    _put_plates(c3d, recording)
    _put_events(c3d, recording)
    c3d.add_parameter("MANUFACTURER", "SOFTWARE", ["gaitlab"])
    for name, value in file_parameters(recording.parameters).items():
        c3d.add_parameter("PROCESSING", name, [float(value)])
    try:
        c3d.write(str(path))
    except (OSError, RuntimeError) as error:
        raise OutputError(f"{path}: the C3D file cannot be written ({error}); choose another folder") from error
    if not path.is_file():
        raise OutputError(f"{path}: the C3D file cannot be written; choose another folder")


def _put_points(c3d: ezc3d.c3d, recording: Recording) -> None:
    points = np.full((4, len(recording.markers), recording.n_frames), np.nan)
    for k, positions in enumerate(recording.markers.values()):
        points[:3, k] = MILLIMETRES * positions.T
    missing = np.isnan(points[:3]).any(axis=0)
    points[:3, missing] = 0.0
    points[3] = 1.0
    c3d["header"]["points"]["first_frame"] = recording.first_frame
    c3d["parameters"]["POINT"]["RATE"]["value"] = np.array([recording.rate])
    c3d["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    c3d["parameters"]["POINT"]["LABELS"]["value"] = list(recording.markers)
    c3d["data"]["points"] = points
    c3d["data"]["meta_points"]["residuals"] = np.where(missing, -1.0, 0.0)[None]
    c3d["data"]["meta_points"]["camera_masks"] = np.zeros((7, *missing.shape), dtype=bool)


def _put_plates(c3d: ezc3d.c3d, recording: Recording) -> None:
    plates = recording.force_plates
    if not plates:
        return
    ratio = round(plates[0].rate / recording.rate)
    n_samples = ratio * recording.n_frames
    axes = ("Force.Fx", "Force.Fy", "Force.Fz", "Moment.Mx", "Moment.My", "Moment.Mz")
    c3d["parameters"]["ANALOG"]["RATE"]["value"] = np.array([ratio * recording.rate])
    c3d["parameters"]["ANALOG"]["LABELS"]["value"] = [f"{axis}{k + 1}" for k in range(len(plates)) for axis in axes]
    c3d["parameters"]["ANALOG"]["UNITS"]["value"] = ["N", "N", "N", "Nmm", "Nmm", "Nmm"] * len(plates)
    samples = np.concatenate([plate_samples(plate) for plate in plates], axis=1)[:n_samples]
    c3d["data"]["analogs"] = samples.T[None]
    corners = np.stack([MILLIMETRES * plate.corners.T for plate in plates], axis=2)  # (3, 4, n)
    c3d.add_parameter("FORCE_PLATFORM", "USED", [len(plates)])
    c3d.add_parameter("FORCE_PLATFORM", "TYPE", [2] * len(plates))
    c3d.add_parameter("FORCE_PLATFORM", "ZERO", [1, 0])
    c3d.add_parameter("FORCE_PLATFORM", "CORNERS", corners)
    c3d.add_parameter("FORCE_PLATFORM", "ORIGIN", np.zeros((3, len(plates))))
    c3d.add_parameter("FORCE_PLATFORM", "CHANNEL", 1.0 + np.arange(6.0 * len(plates)).reshape(-1, 6).T)


def _put_events(c3d: ezc3d.c3d, recording: Recording) -> None:
    start = recording.first_frame / recording.rate
    for event in sorted((*recording.events, *recording.sole_changes), key=lambda event: event.time):
        c3d.add_event([0, start + event.time], context=event.side.capitalize(), label=EVENT_LABELS[event.kind])
