"""All exports of a result folder by the name of their format."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from ..errors import NotFound, OutputError
from .export_c3d import export_c3d, made_from
from .export_fhir import export_fhir
from .export_opensim import export_coordinates, export_ground_reactions, export_trc
from .export_tables import export_csv, export_json
from .result import read_result, trial_directories
from .walk_file import read_walk

ExportFormat = Literal["c3d", "trc", "mot", "fhir", "csv", "json"]
FORMATS: tuple[ExportFormat, ...] = get_args(ExportFormat)


@dataclass(frozen=True, kw_only=True)
class Export:
    """What is exported, from where to where."""

    directory: Path
    """Result folder of one trial or of several."""
    out: Path
    recordings: Sequence[Path] = ()
    """The C3D files that the result was made from, in any order; only for the format c3d."""


def export(job: Export, formats: Sequence[str]) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """Writes the files of all formats.

    Returns:
        The files, and why others were not written.

    Raises:
        NotFound: A format does not exist.
        OutputError: The folder holds no result, a file cannot be written, or c3d lacks its recordings.
        InvalidRecording: result.json does not keep to the contract, or a recording cannot be read.
    """
    unknown = [name for name in formats if name not in FORMATS]
    if unknown:
        raise NotFound("export format", unknown[0], FORMATS)
    read_result(job.directory)
    try:
        job.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{job.out} cannot be made ({error.strerror}): choose another folder") from error
    written: list[Path] = []
    problems: list[str] = []
    for name in dict.fromkeys(formats):
        files, why = _WRITERS[name](job)
        written += files
        problems += why
    return tuple(written), tuple(problems)


Outcome = tuple[tuple[Path, ...], tuple[str, ...]]


def _c3d(job: Export) -> Outcome:
    if not job.recordings:
        raise OutputError("the format c3d appends to a copy of the recording: give the C3D file with --recording")
    trials = {path: read_result(path) for path in trial_directories(job.directory)}
    written: list[Path] = []
    for recording in job.recordings:
        own = next((path for path, result in trials.items() if made_from(result, recording)), None)
        if own is None:
            names = ", ".join(result.name for result in trials.values())
            raise OutputError(f"{recording.name} is no file that this result was made from ({names}, by sha256)")
        target = job.out / f"{recording.stem}_gaitlab.c3d"
        export_c3d(own, recording, target)
        written.append(target)
    left = [result.name for result in trials.values() if not any(made_from(result, file) for file in job.recordings)]
    return tuple(written), tuple(f"{name}: no C3D copy, its recording was not given" for name in left)


def _trc(job: Export) -> Outcome:
    targets = _trials(job)
    for directory, stem in targets:
        export_trc(directory, job.out / f"{stem}.trc")
    return tuple(job.out / f"{stem}.trc" for _, stem in targets), ()


def _mot(job: Export) -> Outcome:
    written: list[Path] = []
    problems: list[str] = []
    for directory, stem in _trials(job):
        coordinates, plates = (job.out / f"{stem}_{what}.mot" for what in ("coordinates", "plates"))
        export_coordinates(directory, coordinates)
        written.append(coordinates)
        forces = read_walk(directory).arrays.get("grf_plates")
        if forces is None or forces.size == 0:
            problems.append(f"{stem}: no ground reactions, the file holds no usable force plate")
            continue
        export_ground_reactions(directory, plates)
        written.append(plates)
    return tuple(written), tuple(problems)


def _fhir(job: Export) -> Outcome:
    target = job.out / f"{_name(job)}_fhir.json"
    export_fhir(job.directory, target)
    return (target,), ()


def _csv(job: Export) -> Outcome:
    return export_csv(job.directory, job.out / _name(job)), ()


def _json(job: Export) -> Outcome:
    target = job.out / f"{_name(job)}.json"
    export_json(job.directory, target)
    return (target,), ()


_WRITERS: Mapping[str, Callable[[Export], Outcome]] = {
    "c3d": _c3d,
    "trc": _trc,
    "mot": _mot,
    "fhir": _fhir,
    "csv": _csv,
    "json": _json,
}


def _name(job: Export) -> str:
    return read_result(job.directory).name


def _trials(job: Export) -> list[tuple[Path, str]]:
    return [(path, read_result(path).name) for path in trial_directories(job.directory)]
