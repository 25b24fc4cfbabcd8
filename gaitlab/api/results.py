"""The files of results: finding, copying and exporting them."""

import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from uuid import UUID

import msgspec
from sqlalchemy import bindparam, select

from ..clinical.comparison import Member, compare
from ..clinical.document import Document
from ..errors import InvalidRequest, OutputError
from ..pipelines.compare import write_tables
from ..storage.models import Job, Recording, Result, ResultFile
from .caller import Call
from .files import copy_out
from .problems import Absent
from .report_files import newest_pdf
from .services import Services

DOCUMENT = "result.json"
SHOWN = ("walk.npz", DOCUMENT)
"""Files of a result that the 3D view reads, in each of its folders."""
EXPORT_SECONDS = 120.0
SCENE_PROCESS, FORMAT_PROCESS = "gaitlab.viewer.export", "gaitlab.report.export_process"


_OF_RESULT = select(ResultFile).where(ResultFile.result_id == bindparam("result_id"))
_FILES, _FILE = _OF_RESULT.order_by(ResultFile.name), _OF_RESULT.where(ResultFile.name == bindparam("name"))


def files_of(call: Call, result_id: UUID) -> list[ResultFile]:
    """Files of a result by name."""
    return list(call.find(_FILES, result_id=result_id).scalars())


def file_of(call: Call, result_id: UUID, name: str) -> ResultFile:
    """One file of a result; raises Absent."""
    found = call.find(_FILE, result_id=result_id, name=name).scalar_one_or_none()
    if found is None:
        raise Absent("file", name)
    return found


def in_trial(trial: str, name: str) -> str:
    """Name of a file of one trial; without a trial, of all together."""
    return f"{trial}/{name}" if trial else name


def copy_files(services: Services, files: Sequence[ResultFile], folder: Path) -> None:
    """Copies of a result's files, in its folders."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in files:
        copy_out(services, file.sha256, folder, file.name)


def read_document(services: Services, sha256: str) -> Document:
    """A stored result.json; raises OutputError for one that an incompatible gaitlab wrote."""
    try:
        return msgspec.json.decode(services.files.read(sha256), type=Document)
    except msgspec.MsgspecError as error:
        raise OutputError(f"the result cannot be read by this version ({error}); run the analysis again") from error


@dataclass(frozen=True, kw_only=True)
class Source:
    """What an export is made of, read from the database, so that no transaction is open while it is made."""

    result_id: UUID
    trial: str
    files: Sequence[ResultFile]
    recording: tuple[str, str] | None
    """Name and SHA-256 of the trial's recording."""
    pdf: str | None
    """SHA-256 of the newest report's PDF."""

    def sha256(self, name: str) -> str:
        """Content of one file of the trial; raises Absent."""
        wanted = in_trial(self.trial, name)
        found = next((file.sha256 for file in self.files if file.name == wanted), None)
        if found is None:
            trials = sorted({file.name.partition("/")[0] for file in self.files if "/" in file.name})
            hint = f"; its trials are {', '.join(trials)}" if trials else ""
            raise InvalidRequest(f"the result has no file {wanted}{hint}")
        return found


def source_of(call: Call, result: Result, trial: str) -> Source:
    """What exports of a result need."""
    return Source(
        result_id=result.id,
        trial=trial,
        files=files_of(call, result.id),
        recording=_recording(call, result, trial),
        pdf=newest_pdf(call, result.id),
    )


def _recording(call: Call, result: Result, trial: str) -> tuple[str, str] | None:
    walks = [each for each in call.db.get_one(Job, result.job_id).inputs if each["role"] == "walk"]
    for walk in walks:
        if Path(walk["name"]).stem == trial or (not trial and len(walks) == 1):
            recording = call.db.get(Recording, UUID(walk["source"]))
            # The recording may have been stripped of names since; then its present content is the one to use.
            sha256 = walk["sha256"] if recording is None else recording.sha256
            return walk["name"], sha256
    return None


def keep_until_sent(services: Services, make: Callable[[Path], Path]) -> tuple[Path, Callable[[], None]]:
    """A file that `make` writes into a temporary folder, and what removes it."""
    folder = services.settings.data_dir / "exports"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    inside = tempfile.TemporaryDirectory(dir=folder, ignore_cleanup_errors=True)
    try:
        return make(Path(inside.name)), inside.cleanup
    except BaseException:
        inside.cleanup()
        raise


def table_file(services: Services, source: Source, table: str, parquet: bool, folder: Path) -> Path:
    """A table of the result as CSV or Parquet."""
    label = str(source.result_id)
    document = read_document(services, source.sha256(DOCUMENT))
    comparison = compare([Member(label=label, group=source.trial or label, document=document)])
    write_tables(comparison, folder, parquet)
    return folder / f"{table}{'.parquet' if parquet else '.csv'}"


def format_file(services: Services, source: Source, kind: str, folder: Path) -> Path:
    """The result in the format of another program; several files become a zip. Made in a process of its own."""
    copy_files(services, [file for file in source.files if not file.name.endswith(".html")], folder / "result")
    recordings: list[str] = []
    if kind == "c3d":
        if source.recording is None:
            raise InvalidRequest("name the trial to export: ?trial=...")
        name, sha256 = source.recording
        recordings.append(str(copy_out(services, sha256, folder / "recording", Path(name).name)))
    out = folder / "out"
    _run(FORMAT_PROCESS, str(_directory(source, folder)), str(out), kind, *recordings)
    made = sorted(path for path in out.rglob("*") if path.is_file())
    if len(made) == 1:
        return made[0]
    target = folder / f"{kind}.zip"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in made:
            archive.write(path, path.relative_to(out))
    return target


def scene_file(services: Services, source: Source, folder: Path) -> Path:
    """A trial in 3D as one page, made in a process of its own."""
    copy_files(services, [file for file in source.files if Path(file.name).name in SHOWN], folder / "result")
    target = folder / "scene.html"
    _run(SCENE_PROCESS, str(folder / "result"), str(target), *([source.trial] if source.trial else []))
    return target


def _directory(source: Source, folder: Path) -> Path:
    return folder / "result" / source.trial if source.trial else folder / "result"


def _run(module: str, *arguments: str) -> None:
    """Run a module of ours; raises OutputError with its sentence when it fails."""
    command = [sys.executable, "-P", "-m", module, *arguments]
    try:
        finished = subprocess.run(command, capture_output=True, text=True, timeout=EXPORT_SECONDS, check=False)
    except subprocess.TimeoutExpired as error:
        raise OutputError(f"the export took longer than {EXPORT_SECONDS:g} s and was stopped") from error
    if finished.returncode != 0:
        lines = finished.stderr.strip().splitlines()
        raise OutputError(lines[-1] if finished.returncode == 1 and lines else "the export ended without a result")
