"""The files of arrays in an output directory: `walk.npz` (the walk in time) and `angles.csv` (angles per frame)."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from ..errors import OutputError


@dataclass(frozen=True, kw_only=True)
class Walk:
    """What `walk.npz` holds; every array but the time may be absent. Laboratory frame, SI units, n frames."""

    time: np.ndarray
    """Time from the first stored frame [s], shape (n,)."""
    arrays: Mapping[str, np.ndarray]
    """The other arrays of the file by name, shape (n, ...) for those with one row per frame."""

    def get(self, name: str) -> np.ndarray | None:
        """Array with one row per frame, shape (n, ...), or None if absent or of another length."""
        array = self.arrays.get(name)
        if array is None or array.ndim == 0 or len(array) != len(self.time):
            return None
        return array

    def numbers(self, name: str, n_axes: int) -> np.ndarray | None:
        """Numerical array of shape (n, ...) with `n_axes` axes and some elements; None if there is no such."""
        array = self.get(name)
        if array is None or array.ndim != n_axes or array.size == 0 or array.dtype.kind not in "fiu":
            return None
        return np.asarray(array, dtype=float)

    def vectors(self, name: str) -> np.ndarray | None:
        """Points or forces [m or N], shape (n, k, 3); None if absent or otherwise shaped."""
        array = self.numbers(name, 3)
        return array if array is not None and array.shape[2] == 3 else None

    def names(self, name: str) -> tuple[str, ...]:
        """Words that do not change in time (contact_names, segment_names ...); empty if absent."""
        array = self.arrays.get(name)
        return () if array is None else tuple(str(word) for word in np.atleast_1d(array))


def read_walk(directory: Path) -> Walk:
    """Read `walk.npz` of one trial; pickled objects are refused.

    Raises:
        OutputError: the file is absent, is no archive of arrays, or has no time.
    """
    path = directory / "walk.npz"
    if not path.is_file():
        raise OutputError(
            f"{directory} has no walk.npz; run 'gaitlab analyse' with this output directory (walk.npz is written once "
            "the walk has been reconstructed)"
        )
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except (OSError, ValueError, EOFError, BadZipFile) as error:
        raise OutputError(
            f"{path} is not a readable archive of arrays ({error}); run 'gaitlab analyse' again"
        ) from error
    time = arrays.pop("time", np.zeros(0))
    if time.ndim != 1 or time.size == 0 or time.dtype.kind not in "fiu" or not np.all(np.isfinite(time)):
        raise OutputError(f"{path} has no usable 'time' of shape (n,) in seconds; run 'gaitlab analyse' again")
    return Walk(time=np.asarray(time, dtype=float), arrays=arrays)


@dataclass(frozen=True, kw_only=True)
class Frames:
    """What `angles.csv` or `kinetics.csv` holds: curves of every stored frame, clinical signs."""

    time: np.ndarray
    """Time from the first stored frame [s], shape (n,)."""
    curves: Mapping[str, np.ndarray]
    """left_hip_flexion ... to angles [deg], or left_hip_power ... in their units, shape (n,); NaN where missing."""


def read_curves(path: Path) -> Frames | None:
    """Read the table of one trial; None if it is absent.

    Raises:
        OutputError: the file is there but is not a table of numbers with a column `time`.
    """
    table = read_frames(path)
    return None if table is None else Frames(time=table.pop("time"), curves=table)


def read_frames(path: Path) -> dict[str, np.ndarray] | None:
    """Columns of a table with one row per frame, shape (n,) each, `time` [s] first; None if the file is absent.

    An empty cell is NaN.

    Raises:
        OutputError: the file is there but is not a table of numbers with a column `time`.
    """
    if not path.is_file():
        return None
    try:
        with path.open(newline="", encoding="utf-8") as stream:
            header, *rows = list(csv.reader(stream)) or [[]]
        table = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows], dtype=float)
    except (OSError, ValueError, csv.Error) as error:
        raise OutputError(f"{path} is not a table of numbers ({error}); run 'gaitlab analyse' again") from error
    columns = dict(zip(header, table.T, strict=True)) if table.shape == (len(rows), len(header)) else {}
    if "time" not in columns:
        raise OutputError(f"{path} has no column 'time' or no rows; run 'gaitlab analyse' again")
    return columns
