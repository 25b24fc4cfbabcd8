"""Export to C3D: the recording as it is, with angles, moments and powers of the result as further points."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..clinical.document import SIDES
from ..errors import OutputError
from ..mocap.c3d_append import append_outputs
from ..mocap.point_output import OutputKind, PointOutput
from .result import Result, mapping, read_result
from .source import file_hash
from .walk_file import read_frames

Columns = Mapping[str, np.ndarray]
_NONE = ""
POINTS: Sequence[tuple[str, OutputKind, tuple[str, str, str]]] = (
    ("PelvisAngles", "ANGLES", ("pelvis_tilt", "pelvis_obliquity", "pelvis_rotation")),
    ("HipAngles", "ANGLES", ("hip_flexion", "hip_adduction", "hip_rotation")),
    ("KneeAngles", "ANGLES", ("knee_flexion", _NONE, _NONE)),
    ("AnkleAngles", "ANGLES", ("ankle_dorsiflexion", _NONE, _NONE)),
    ("FootProgressAngles", "ANGLES", (_NONE, _NONE, "foot_progression")),
    ("HipMoment", "MOMENTS", ("hip_extensor_moment", "hip_abductor_moment", "hip_external_rotator_moment")),
    ("KneeMoment", "MOMENTS", ("knee_extensor_moment", "knee_abductor_moment", "knee_external_rotator_moment")),
    ("AnkleMoment", "MOMENTS", ("ankle_plantarflexor_moment", "ankle_evertor_moment", "ankle_external_rotator_moment")),
    ("HipPower", "POWERS", (_NONE, _NONE, "hip_power")),
    ("KneePower", "POWERS", (_NONE, _NONE, "knee_power")),
    ("AnklePower", "POWERS", (_NONE, _NONE, "ankle_power")),
)
"""Names, components and signs of Plug-in Gait, after L or R; a component without a name is 0."""


def export_c3d(directory: Path, recording: Path, target: Path) -> None:
    """Writes a copy of `recording` with the curves of the result in `directory`, one trial, as further points.

    Angles [deg], moments [N*m/kg, in the unit that the file states for moments], powers [W/kg]; a frame in which a
    component is unknown has none. All other contents of the file stay as they are, a person's name included.

    Raises:
        OutputError: The result holds no angles, or was made from another recording, or nothing can be written.
        InvalidRecording: The recording cannot be read.
    """
    result = read_result(directory)
    check_recording(result, recording)
    append_outputs(recording, target, point_outputs(directory, str(result.part("kinetics").get("moments_in") or "")))


def check_recording(result: Result, recording: Path) -> None:
    """Raises OutputError unless one of the walks of the result is this file, byte by byte."""
    if not made_from(result, recording):
        walks = ", ".join(str(mapping(item).get("name")) for item in result.parts("inputs")) or "no file"
        raise OutputError(f"{recording.name} is not the file that this result was made from ({walks}, by its sha256)")


def made_from(result: Result, recording: Path) -> bool:
    """Whether one of the walks of the result is this file, by its sha256; raises OutputError."""
    walks = [mapping(item) for item in result.parts("inputs") if mapping(item).get("role") == "walk"]
    return file_hash(recording) in {walk.get("sha256") for walk in walks}


def point_outputs(directory: Path, moments_in: str = "") -> tuple[PointOutput, ...]:
    """Angles and, where the result has them, moments and powers of both sides per stored frame.

    Args:
        directory: Of one trial.
        moments_in: Axes that the moments are expressed in, in words.

    Raises:
        OutputError: There are no angles.
    """
    angles = read_frames(directory / "angles.csv")
    if angles is None:
        raise OutputError(f"{directory} has no angles.csv; give the folder of one trial that 'gaitlab analyse' wrote")
    columns = angles | (read_frames(directory / "kinetics.csv") or {})
    found = [_point(columns, side, *point) for side in SIDES for point in POINTS]
    known = [point for point in found if point is not None]
    return tuple(
        replace(p, meaning=f"{p.meaning}; internal, in {moments_in or 'axes that are not stated'}")
        if p.kind == "MOMENTS"
        else p
        for p in known
    )


def _point(
    columns: Columns, side: str, name: str, kind: OutputKind, components: tuple[str, str, str]
) -> PointOutput | None:
    keys = [f"{side}_{component}" if component else _NONE for component in components]
    if any(key and key not in columns for key in keys):
        return None
    nothing = np.zeros_like(columns["time"])
    meaning = ", ".join(component.replace("_", " ") or "not computed" for component in components)
    values = np.column_stack([columns[key] if key else nothing for key in keys])
    return PointOutput(label=side[0].upper() + name, kind=kind, values=values, meaning=meaning)
