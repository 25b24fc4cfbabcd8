"""A result that the command line computed, in the database as if a job had produced it."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sqlalchemy.orm import Session

from ..errors import OutputError
from ..storage.files import FileStore
from ..storage.models import Job, JobPatient, JobStatus, Result, ResultFile
from ..storage.references import refer
from ..storage.schema import now
from .request import JobRequest
from .tasks import media_type

DOCUMENT = "result.json"
SOLVED = "solved"


def import_result(session: Session, store: FileStore, request: JobRequest, folder: Path) -> Result:
    """Keep the files that `gaitlab analyse --out` wrote, with a job that has ended.

    Args:
        session: The transaction; at its end the result is there, or nothing.
        store: Keeps the files.
        request: What a job would have been asked for.
        folder: The output directory.

    Raises:
        OutputError: The folder holds no result.
    """
    document = _document(folder)
    moment = now()
    job = Job(
        kind=request.kind,
        input_hash=request.input_hash,
        session_id=request.session_id,
        created_by=request.created_by,
        inputs=[each.as_json() for each in request.inputs],
        settings=dict(request.settings),
        status=JobStatus.SUCCEEDED,
        attempt=1,
        started_at=moment,
        finished_at=moment,
    )
    session.add(job)
    session.flush()
    session.add_all(JobPatient(job_id=job.id, patient_id=patient) for patient in request.patients)
    result = Result(
        job_id=job.id, kind=job.kind, session_id=job.session_id, attempt=1, **_facts(document), provenance=_origin(job)
    )
    session.add(result)
    session.flush()
    _keep_files(session, store, result, folder)
    return result


def _document(folder: Path) -> Mapping[str, Any]:
    try:
        return json.loads((folder / DOCUMENT).read_bytes())
    except (OSError, ValueError) as error:
        raise OutputError(f"{folder} holds no {DOCUMENT} to read; give what 'gaitlab analyse' wrote") from error


def _facts(document: Mapping[str, Any]) -> dict[str, Any]:
    """What lists of results show, as the analysis itself tells it."""
    weights: Mapping[str, Any] | None = document.get("weights")
    solver: Mapping[str, Any] = {} if weights is None else weights["solver"]
    converged = weights is None or solver["status"] == SOLVED
    walks = [Path(each["name"]).stem for each in document["inputs"] if each["role"] == "walk"]
    criteria = None if weights is None else {each["name"]: each["weight"] for each in weights["criteria"]}
    summary = {"trials": walks, "warnings": len(document["warnings"]), "weights": criteria}
    return {"converged": converged, "message": "" if converged else str(solver.get("message", "")), "summary": summary}


def _origin(job: Job) -> dict[str, Any]:
    return {"inputs": job.inputs, "settings": job.settings, "worker": "command line", "attempt": 1}


def _keep_files(session: Session, store: FileStore, result: Result, folder: Path) -> None:
    paths = [path for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()]
    kept = {path.relative_to(folder).as_posix(): store.put_file(path) for path in paths}
    for stored in sorted(kept.values(), key=lambda each: each.sha256):
        refer(session, store, stored)
    session.add_all(
        ResultFile(result_id=result.id, name=name, media_type=media_type(name), sha256=stored.sha256, size=stored.size)
        for name, stored in kept.items()
    )
