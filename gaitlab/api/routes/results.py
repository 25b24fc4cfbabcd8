"""Results: what they hold, their files, and exports in the formats of others."""

from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Annotated, Any, Literal
from uuid import UUID

import msgspec
from fastapi import Query, Response
from pydantic import Field
from sqlalchemy import bindparam, delete, exists, select
from starlette.background import BackgroundTask
from starlette.responses import FileResponse

from ...errors import AccessDenied, Conflict
from ...storage.models import CohortMember, GaitSession, JobPatient, ReportVersion, ResultFile
from ...storage.models import Result as ResultRow
from ...storage.references import remove_unused
from .. import visibility
from ..caller import Call
from ..dependencies import Asker, allowed, allowed_slowly
from ..files import content, disposition, stream
from ..headers import DOCUMENT as DOCUMENT_POLICY
from ..headers import SCENE as SCENE_POLICY
from ..listing import Listing, page
from ..permissions import Permission
from ..pseudonyms import mask, masked_names
from ..results import (
    DOCUMENT,
    Source,
    file_of,
    files_of,
    format_file,
    in_trial,
    keep_until_sent,
    scene_file,
    source_of,
    table_file,
)
from ..routing import api_router
from ..schemas.forms import Input, Line, Page
from ..schemas.work import Result, ResultFilter, ResultWithFiles

router = api_router("/results", tag="results")
Reader = Annotated[Call, allowed(Permission.RESULTS_READ)]
NameReader = Annotated[Call, allowed(Permission.IDENTITIES_READ)]
Exporter = Annotated[Asker, allowed_slowly(Permission.RESULTS_READ)]
Remover = Annotated[Asker, allowed_slowly(Permission.RESULTS_DELETE)]
Trial = Annotated[Line, Query(description="Name of one walk; empty: all together.")]
Format = Literal["json", "csv", "parquet", "npz", "html", "pdf", "c3d", "trc", "mot", "fhir", "scene"]
MEDIA: dict[Format, str] = {
    "json": "application/json",
    "csv": "text/csv",
    "parquet": "application/vnd.apache.parquet",
    "npz": "application/octet-stream",
    "html": "text/html",
    "pdf": "application/pdf",
    "c3d": "application/octet-stream",
    "trc": "text/plain",
    "mot": "text/plain",
    "fhir": "application/fhir+json",
    "scene": "text/html",
}
WITH_NAMES = frozenset({"html", "pdf", "c3d", "trc", "mot", "fhir"})
"""Formats that may hold names."""
EXPORTS = content(*sorted({*MEDIA.values(), "application/zip"}))
POLICIES = {"html": DOCUMENT_POLICY, "scene": SCENE_POLICY}


class ExportChoice(Input):
    """What to export."""

    trial: Line = Field(default="", description="Name of one walk; empty: all together.")
    table: Literal["quantities", "weights", "curves", "bands", "missing"] = Field(
        default="curves", description="With csv and parquet: which table."
    )


def _answer(call: Call, row: ResultRow, patient_id: UUID | None) -> Result:
    told: dict[str, Any] = {"message": row.message, "summary": row.summary, "provenance": row.provenance}
    if not call.caller.sees_names:
        told = mask(told, masked_names(call, [] if row.session_id is None else [row.session_id]))
    return Result(
        id=row.id,
        created_at=row.created_at,
        job_id=row.job_id,
        kind=row.kind,
        session_id=row.session_id,
        patient_id=patient_id,
        converged=row.converged,
        message=told["message"],
        summary=told["summary"],
        provenance=told["provenance"],
    )


@cache
def _listing(sees_all: bool, filters: frozenset[str]) -> Listing:
    """Results for which the parameters named by `filters` hold."""
    query = select(ResultRow, GaitSession.patient_id).outerjoin(GaitSession, GaitSession.id == ResultRow.session_id)
    query = query.where(visibility.visible_job(sees_all, ResultRow.job_id))
    if "patient_id" in filters:
        mine = exists().where(JobPatient.job_id == ResultRow.job_id, JobPatient.patient_id == bindparam("patient_id"))
        query = query.where(mine)
    if "session_id" in filters:
        query = query.where(ResultRow.session_id == bindparam("session_id"))
    if "kind" in filters:
        query = query.where(ResultRow.kind == bindparam("kind"))
    return Listing(query.order_by(ResultRow.created_at.desc(), ResultRow.id))


@router.get("")
def list_results(call: Reader, which: Annotated[ResultFilter, Query()]) -> Page[Result]:
    """Results on visible patients, newest first."""
    call.audit("list", "results", patient_id=which.patient_id)
    given = {"patient_id": which.patient_id, "session_id": which.session_id, "kind": which.kind}
    values = {name: value for name, value in given.items() if value is not None}
    rows = _listing(call.caller.sees_all, frozenset(values))
    return page(call, rows, which, lambda row: _answer(call, row[0], row[1]), **values)


@router.get("/{result_id}")
def get_result(call: Reader, result_id: UUID) -> ResultWithFiles:
    """One result with its files."""
    row = visibility.result(call, result_id, "read")
    answer = _answer(call, row, None if row.session_id is None else visibility.patient_of(call, row.session_id))
    names = {} if call.caller.sees_names else masked_names(call, [row.session_id] if row.session_id else [])
    files = [
        {"name": mask(file.name, names), "media_type": file.media_type, "sha256": file.sha256, "size": file.size}
        for file in files_of(call, result_id)
    ]
    return ResultWithFiles.model_validate({**answer.model_dump(), "files": files})


@router.get("/{result_id}/document", response_class=Response, responses=content("application/json"))
def get_result_document(call: Reader, result_id: UUID, trial: Trial = "") -> Response:
    """The whole result as JSON; `GET /schemas/result` describes it."""
    row = visibility.result(call, result_id, "read")
    return _document(call, row, trial)


def _document(call: Call, row: ResultRow, trial: str) -> Response:
    if call.caller.sees_names:
        file = file_of(call, row.id, in_trial(trial, DOCUMENT))
        return stream(call, file.sha256, "application/json", "result.json", file.size)
    masks = masked_names(call, [] if row.session_id is None else [row.session_id])
    real = next((name for name, number in masks.items() if number == trial), trial)
    file = file_of(call, row.id, in_trial(real, DOCUMENT))
    told = mask(msgspec.json.decode(call.services.files.read(file.sha256)), masks)
    return Response(msgspec.json.encode(told), media_type="application/json")


@router.get("/{result_id}/files/{name:path}", response_class=Response, responses=content("*/*"))
def download_result_file(call: NameReader, result_id: UUID, name: str) -> Response:
    """One file of a result as it is stored."""
    visibility.result(call, result_id, "export", "result_files", f"{result_id}/{name}")
    file = file_of(call, result_id, name)
    called = Path(name).name
    return stream(call, file.sha256, file.media_type, called, file.size, content_security_policy=DOCUMENT_POLICY)


@router.get(
    "/{result_id}/exports/{kind}",
    response_class=Response,
    responses=content(*sorted({*MEDIA.values(), "application/zip"})),
)
def export_result(asker: Exporter, result_id: UUID, kind: Format, choice: Annotated[ExportChoice, Query()]) -> Response:
    """The result in another format.

    json: the document; csv, parquet: a table; npz: the walk in time; html, pdf: the report; c3d: the recording with
    angles, moments and powers; trc, mot: OpenSim; fhir: observations; scene: the walk in 3D as one page.
    """
    with asker.begin() as call:
        if kind in WITH_NAMES and not asker.caller.sees_names:
            raise AccessDenied(
                f"{kind} may hold names; you see pseudonyms only: export json, csv, parquet, npz or scene"
            )
        row = visibility.result(call, result_id, "export")
        if kind == "json":
            return _document(call, row, choice.trial)
        source = source_of(call, row, choice.trial)
        stored = {"npz": "walk.npz", "html": "report.html"}.get(kind)
        if stored is not None or kind == "pdf":
            return _stored(call, source, kind, stored)
    return _made(asker, source, kind, choice)


def _stored(call: Call, source: Source, kind: Format, name: str | None) -> Response:
    sha256 = source.pdf if name is None else source.sha256(name)
    if sha256 is None:
        raise Conflict("there is no PDF yet: ask for a report first (POST /reports)")
    policy = POLICIES.get(kind, DOCUMENT_POLICY)
    return stream(call, sha256, MEDIA[kind], name or "report.pdf", content_security_policy=policy)


def _made(asker: Asker, source: Source, kind: Format, choice: ExportChoice) -> Response:
    def make(folder: Path) -> Path:
        if kind == "scene":
            return scene_file(asker.services, source, folder)
        if kind in ("csv", "parquet"):
            return table_file(asker.services, source, choice.table, kind == "parquet", folder)
        return format_file(asker.services, source, kind, folder)

    path, remove = keep_until_sent(asker.services, make)
    headers = {"content-disposition": disposition(path.name)}
    if kind in POLICIES:
        headers["content-security-policy"] = POLICIES[kind]
    media_type = "application/zip" if path.suffix == ".zip" else MEDIA[kind]
    return FileResponse(path, media_type=media_type, headers=headers, background=BackgroundTask(remove))


@router.delete("/{result_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_result(asker: Remover, result_id: UUID) -> None:
    """Delete a result; a report that was made of it must go first."""
    with asker.begin() as call:
        row = visibility.result(call, result_id, "delete")
        if call.db.scalar(select(exists().where(ReportVersion.result_id == result_id))):
            raise Conflict("a report is made of this result, so it stays")
        digests = [file.sha256 for file in files_of(call, result_id)]
        call.db.execute(delete(CohortMember).where(CohortMember.result_id == result_id))
        call.db.execute(delete(ResultFile).where(ResultFile.result_id == result_id))
        call.db.delete(row)
        _forget_job(call, row.job_id)
    remove_unused(asker.services.database, asker.services.files, digests)


def _forget_job(call: Call, job_id: UUID) -> None:
    """Without its result the job would count as done, and an equal request would never be computed again."""
    call.db.flush()
    call.db.execute(delete(JobPatient).where(JobPatient.job_id == job_id))
    call.db.delete(call.db.get_one(visibility.Job, job_id))
