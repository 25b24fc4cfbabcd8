"""A result that the command line computed, in the database as if a job had produced it."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sqlalchemy.orm import Session

from ..errors import OutputError
from ..storage.files import FileStore
from ..storage.models import Job, JobStatus, Result
from ..storage.schema import now
from .queue import add_job
from .request import JobRequest
from .results import add_result

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
    job = add_job(session, request, status=JobStatus.SUCCEEDED, attempt=1, started_at=moment, finished_at=moment)
    result = Result(
        job_id=job.id, kind=job.kind, session_id=job.session_id, attempt=1, **_facts(document), provenance=_origin(job)
    )
    paths = [path for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()]
    add_result(session, store, result, {path.relative_to(folder).as_posix(): store.put_file(path) for path in paths})
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
