"""Results appended to a copy of a C3D file; whatever the file holds stays as it is.

Like the reader, this works on files from anywhere, so it runs in a process of its own (`append_outputs`).
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import ezc3d
import numpy as np

from gaitlab.errors import InvalidRecording, OutputError
from gaitlab.mocap.c3d import extract
from gaitlab.mocap.labels import strip_prefix
from gaitlab.mocap.point_output import OutputKind, PointOutput, save_outputs
from gaitlab.mocap.raw import RawRecording
from gaitlab.mocap.sandbox import ReaderLimits, run_child

CHILD = "gaitlab.mocap.c3d_append_child"
SUFFIX = "_gaitlab"
MOST_ENTRIES = 255  # of a parameter
UNITS: dict[OutputKind, tuple[str, str, dict[str, float]]] = {
    "ANGLES": ("ANGLE_UNITS", "deg", {"deg": 1.0, "degrees": 1.0, "rad": np.pi / 180.0}),
    "MOMENTS": ("MOMENT_UNITS", "Nmm/kg", {"nmm": 1000.0, "nmm/kg": 1000.0, "nm": 1.0, "nm/kg": 1.0}),
    "POWERS": ("POWER_UNITS", "W/kg", {"w": 1.0, "w/kg": 1.0, "mw": 1000.0, "mw/kg": 1000.0}),
}
"""Parameter of POINT, what it says where the file has none, and the file's unit over ours. Vicon omits the /kg."""


def append_outputs(
    source: Path, target: Path, outputs: Sequence[PointOutput], limits: ReaderLimits | None = None
) -> None:
    """Writes a copy of the C3D file `source` with the outputs as further points, in the units that the file states.

    Labels that the file uses already are no reason to touch its points: then all new labels end in "_gaitlab". The
    group GAITLAB lists the labels with their meaning.

    Raises:
        InvalidRecording: The file cannot be read, or has another number of frames.
        OutputError: The copy cannot be written.
    """
    limits = limits or ReaderLimits()
    with tempfile.TemporaryDirectory(prefix="gaitlab-") as folder:
        values, copy = Path(folder) / "outputs.npz", Path(folder) / "copy.c3d"
        save_outputs(values, outputs)
        run_child(source, CHILD, (values, copy), limits)
        try:
            target.write_bytes(copy.read_bytes())
        except OSError as error:
            raise OutputError(f"{target} cannot be written ({error.strerror}): choose another folder") from error


def append_here(source: Path, outputs: Sequence[PointOutput], target: Path) -> None:
    """Does the work in this process; only the child process and tests call it.

    Raises:
        InvalidRecording: Another number of frames, an unknown unit, or the library changed what was there.
    """
    c3d = ezc3d.c3d(str(source), extract_forceplat_data=False)
    n_frames = c3d["data"]["points"].shape[2]
    if any(len(output.values) != n_frames for output in outputs):
        counts = sorted({len(output.values) for output in outputs})
        raise InvalidRecording(f"the results have {counts} frames, the file has {n_frames}, so they are of another one")
    _make_texts_plain(c3d)
    labels = _free_labels(c3d, outputs)
    _put_points(c3d, np.stack([_in_file_units(c3d, output) for output in outputs], axis=2))
    _extend(c3d, "POINT", "LABELS", labels)
    for kind in UNITS:
        of_kind = [label for label, output in zip(labels, outputs, strict=True) if output.kind == kind]
        _extend(c3d, "POINT", kind, of_kind)
    _extend(c3d, "GAITLAB", "LABELS", labels)
    _extend(c3d, "GAITLAB", "MEANING", [output.meaning for output in outputs])
    c3d.write(str(target))
    _compare(extract(source), extract(target))


def _make_texts_plain(c3d: ezc3d.c3d) -> None:
    """Texts that are not UTF-8 are taken as Latin-1: the library reads such bytes but refuses to write them."""
    for members in c3d["parameters"].values():
        for name, entry in members.items():
            if name[:2] != "__" and isinstance(entry["value"], list):
                entry["value"] = [_plain(text) for text in entry["value"]]


def _plain(text: str) -> str:
    if not any(0xDC80 <= ord(letter) <= 0xDCFF for letter in text):
        return text
    return text.encode("utf-8", "surrogateescape").decode("latin-1")


def _free_labels(c3d: ezc3d.c3d, outputs: Sequence[PointOutput]) -> list[str]:
    points = c3d["parameters"]["POINT"]
    numbers = [name for name in points if name == "LABELS" or (name[:6] == "LABELS" and name[6:].isdigit())]
    used = {strip_prefix(label)[1] for name in numbers for label in points[name]["value"]}
    suffix = ""
    while any(output.label + suffix in used for output in outputs):
        suffix += SUFFIX
    return [output.label + suffix for output in outputs]


def _in_file_units(c3d: ezc3d.c3d, output: PointOutput) -> np.ndarray:
    """Values in the unit that the file states for its kind, shape (3, n_frames)."""
    name, default, factors = UNITS[output.kind]
    points = c3d["parameters"]["POINT"]
    if name not in points or not points[name]["value"]:
        c3d.add_parameter("POINT", name, [default])
    stated = str(points[name]["value"][0]).strip()
    factor = factors.get(stated.lower().replace(".", "").replace("*", "").replace("·", ""))
    if factor is None:
        raise InvalidRecording(f"POINT:{name} of the file is '{stated}', known are {', '.join(factors)}")
    return factor * output.values.T


def _put_points(c3d: ezc3d.c3d, values: np.ndarray) -> None:
    """Appends values of shape (3, n_frames, k) to the points; a frame that is not known gets residual -1."""
    values = np.moveaxis(values, 2, 1)  # (3, k, n)
    missing = ~np.isfinite(values).all(axis=0)
    whole = np.concatenate([np.where(missing, 0.0, values), np.ones((1, *missing.shape))])
    data, meta = c3d["data"], c3d["data"]["meta_points"]
    data["points"] = np.concatenate([data["points"], whole], axis=1)
    meta["residuals"] = np.concatenate([meta["residuals"], np.where(missing, -1.0, 0.0)[None]], axis=1)
    masks = np.zeros((7, *missing.shape), dtype=bool)
    meta["camera_masks"] = np.concatenate([meta["camera_masks"], masks], axis=1)


def _extend(c3d: ezc3d.c3d, group: str, name: str, texts: list[str]) -> None:
    """Appends to the list GROUP:NAME, or to NAME2, NAME3 ... so that none grows too long."""
    members = c3d["parameters"].get(group, {})
    number = 1
    while f"{name}{number + 1}" in members:
        number += 1
    while texts:
        last = name if number == 1 else f"{name}{number}"
        kept = list(members[last]["value"]) if last in members else []
        room = MOST_ENTRIES - len(kept)
        c3d.add_parameter(group, last, [*kept, *texts[:room]])
        texts, number = texts[room:], number + 1


def _compare(before: RawRecording, after: RawRecording) -> None:
    """Raises InvalidRecording unless all points and channels of the file are in the copy as they were."""
    n = before.points.shape[1]
    same = (
        np.array_equal(before.points, after.points[:, :n], equal_nan=True)
        and np.array_equal(before.analog, after.analog)
        and (before.labels, before.rate, before.first_frame, before.analog_rate)
        == (after.labels[:n], after.rate, after.first_frame, after.analog_rate)
    )
    if not same:
        raise InvalidRecording("the C3D library would change this file's own data, so no copy is written")
