"""What a job is asked for: its kind, its files, its settings."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any
from uuid import UUID

from .. import __version__
from ..errors import InvalidRecording
from ..storage.models import JobKind

QUICK, SOLVE = "quick", "solve"
QUEUES: Mapping[JobKind, str] = {
    JobKind.INSPECT: QUICK,
    JobKind.REPORT: QUICK,
    JobKind.COMPARE: QUICK,
    JobKind.NORMS: QUICK,
    JobKind.ANALYSE: SOLVE,
    JobKind.PREDICT: SOLVE,
}
"""Queue of each kind, so that the look into an upload does not wait behind hours of computation."""
OWNER = "subject_id"
"""Setting that no computation reads: the row of body measurements that gains the job's model."""


@dataclass(frozen=True, kw_only=True)
class JobInput:
    """A file that a job reads."""

    role: str
    """static, walk, result, norms, basis ..."""
    name: str
    """Path that the file has inside the job's folder, with /."""
    sha256: str
    source: UUID
    """The recording or the result that it belongs to."""
    extra: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """What else the computation needs to know of it: label, group."""

    def __post_init__(self) -> None:
        parts = PurePosixPath(self.name).parts
        if not parts or ".." in parts or "\\" in self.name or "\x00" in self.name or parts[0] == "/":
            raise InvalidRecording(f"{self.name!r} is no file name: use one without folders above it")

    def as_json(self) -> dict[str, Any]:
        """As it stands in the row."""
        plain = {"role": self.role, "name": self.name, "sha256": self.sha256, "source": str(self.source)}
        return plain | ({"extra": dict(self.extra)} if self.extra else {})


@dataclass(frozen=True, kw_only=True)
class JobRequest:
    """What is wanted, by whom, of whose data."""

    kind: JobKind
    inputs: tuple[JobInput, ...]
    patients: frozenset[UUID]
    """Whose data it reads; deleting one of them deletes the job."""
    settings: Mapping[str, Any] = field(default_factory=dict[str, Any])
    session_id: UUID | None = None
    priority: int = 0
    created_by: UUID | None = None
    request_id: str = ""

    @property
    def input_hash(self) -> str:
        """SHA-256 of everything that the result depends on, and of whose it is: nobody gets a result of another's."""
        whole = {
            "kind": self.kind.value,
            "gaitlab": __version__,
            "inputs": [each.as_json() for each in self.inputs],
            "settings": dict(self.settings),
            "patients": sorted(map(str, self.patients)),
            "session": str(self.session_id or ""),
        }
        return hashlib.sha256(json.dumps(whole, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


@dataclass(frozen=True, kw_only=True)
class Work:
    """What the computing process gets: files in a folder, and a folder to write into."""

    kind: str
    settings: Mapping[str, Any]
    inputs: tuple[Mapping[str, Any], ...]
    """As `JobInput.as_json`."""
    folder: Path
    """Holds `inputs`, by name, and `out`."""

    def paths(self, role: str) -> list[Path]:
        """Files of a role, in the order of the request."""
        return [self.folder / "inputs" / each["name"] for each in self.inputs if each["role"] == role]

    @property
    def out(self) -> Path:
        """Folder of what comes out."""
        return self.folder / "out"
