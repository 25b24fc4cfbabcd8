"""Everything a report is made from, read from a result folder before anything is drawn."""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from ..clinical.examination import Examination, read_examination
from ..errors import OutputError
from .result import Result, read_result, trial_directories
from .walk_file import Frames, Walk, read_curves, read_walk

EXAMINATION = "examination.json"
"""Name of the clinical examination in a result folder."""
T = TypeVar("T")
_FILES = ("result.json", "angles.csv", "kinetics.csv", "walk.npz")


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One walk."""

    result: Result
    angles: Frames | None = None
    kinetics: Frames | None = None
    """Moments [N*m/kg], powers [W/kg] and ground reactions [% of body weight]."""
    walk: Walk | None = None
    problems: Mapping[str, str] = field(default_factory=dict[str, str])
    """Why `angles`, `kinetics` or `walk` are absent, by these names."""


@dataclass(frozen=True, kw_only=True)
class Source:
    """One session."""

    overall: Result
    trials: tuple[Trial, ...]
    """At least one; of one walk it holds the overall document again."""
    examination: Examination | None = None
    hashes: Mapping[str, str] = field(default_factory=dict[str, str])
    """SHA-256 of every file that was read, by its path inside the folder."""

    @property
    def several(self) -> bool:
        """Whether the trials have documents of their own."""
        return self.trials[0].result is not self.overall

    @property
    def name(self) -> str:
        """Pseudonym of the person, or the name of the result."""
        given = self.examination.patient.pseudonym if self.examination is not None else ""
        return given or self.overall.name


def read_source(directory: Path, beside: Path | None = None) -> Source:
    """Read a result folder; what cannot be read of tables and arrays becomes a reason instead.

    Args:
        directory: The result folder.
        beside: Folder that holds the clinical examination, if it is another one.

    Raises:
        OutputError: result.json is absent or broken.
        InvalidSubject: examination.json is broken.
    """
    overall = read_result(directory)
    folders = trial_directories(directory)
    alone = folders == (directory,)
    trials = tuple(_trial(folder, overall if alone else read_result(folder)) for folder in folders)
    examination = (beside or directory) / EXAMINATION
    return Source(
        overall=overall,
        trials=trials,
        examination=read_examination(examination) if examination.is_file() else None,
        hashes=source_hashes(directory, beside),
    )


def source_hashes(directory: Path, beside: Path | None = None) -> dict[str, str]:
    """SHA-256 of every file that a report is made from, by its path inside the folder; arguments of `read_source`."""
    folders = dict.fromkeys((directory, *trial_directories(directory)))
    paths = [folder / name for folder in folders for name in _FILES if (folder / name).is_file()]
    found = {path.relative_to(directory).as_posix(): file_hash(path) for path in paths}
    examination = (beside or directory) / EXAMINATION
    return found | ({EXAMINATION: file_hash(examination)} if examination.is_file() else {})


def file_hash(path: Path) -> str:
    """SHA-256 of a file.

    Raises:
        OutputError: The file cannot be read.
    """
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise OutputError(f"{path} cannot be read ({error.strerror})") from error


def _trial(directory: Path, result: Result) -> Trial:
    problems = dict[str, str]()
    angles, problems["angles"] = _read(read_curves, directory / "angles.csv", directory)
    kinetics, problems["kinetics"] = _read(read_curves, directory / "kinetics.csv", directory)
    walk, problems["walk"] = _read(read_walk, directory, directory)
    known = {name: why for name, why in problems.items() if why}
    return Trial(result=result, angles=angles, kinetics=kinetics, walk=walk, problems=known)


def _read(reader: Callable[[Path], T | None], path: Path, directory: Path) -> tuple[T | None, str]:
    """What was read, and why nothing could be read; empty without a problem."""
    try:
        return reader(path), ""
    except OutputError as error:
        return None, _without_path(error, directory)


def _without_path(error: OutputError, directory: Path) -> str:
    # A path may hold a name that must not travel with the page.
    return str(error).replace(f"{directory / 'x'}"[:-1], "").replace(str(directory), "the directory")
