"""Computations: asking for them, watching them, ending them."""

import asyncio
import json
from collections.abc import AsyncIterator
from http import HTTPStatus
from typing import Annotated, Any
from uuid import UUID

from fastapi import Query, Response
from sqlalchemy import exists, select
from sqlalchemy.orm import aliased
from starlette.concurrency import run_in_threadpool
from starlette.responses import StreamingResponse

from ...errors import Conflict
from ...jobs import queue
from ...storage.models import FINAL, JobPatient, JobStatus, Recording, Result
from ...storage.models import Job as JobRow
from .. import visibility
from ..caller import Call
from ..dependencies import Asker, allowed, allowed_slowly
from ..listing import page
from ..orders import again, order
from ..permissions import Permission
from ..pseudonyms import mask, masked_names
from ..repetition import RepetitionKey, once
from ..routing import api_router
from ..schemas.forms import Page
from ..schemas.work import Job, JobFilter, JobInput, NewJob, PriorityChange, Progress

KEEP_ALIVE = 15.0
"""Time without news after which a comment is sent, so that proxies keep the connection open [s]."""
router = api_router("/analyses", tag="analyses")
Reader = Annotated[Call, allowed(Permission.ANALYSES_READ)]
Runner = Annotated[Call, allowed(Permission.ANALYSES_RUN)]
Manager = Annotated[Call, allowed(Permission.SYSTEM_READ)]
Listener = Annotated[Asker, allowed_slowly(Permission.ANALYSES_READ)]
EVENTS: dict[int | str, dict[str, Any]] = {
    200: {"description": "Events until the job is over.", "content": {"text/event-stream": {}}}
}


def _answer(call: Call, row: JobRow, result_id: UUID | None) -> Job:
    told: dict[str, Any] = {"inputs": row.inputs, "progress": row.progress, "error": row.error, "failure": row.failure}
    if not call.caller.sees_names:
        told = mask(told, masked_names(call, _sessions_read(call, row)))
    return Job(
        id=row.id,
        created_at=row.created_at,
        kind=row.kind,
        status=row.status,
        session_id=row.session_id,
        created_by=row.created_by,
        inputs=[JobInput.model_validate(each) for each in told["inputs"]],
        settings=row.settings,
        priority=row.priority,
        attempt=row.attempt,
        cancel_requested=row.cancel_requested,
        progress=Progress.model_validate(told["progress"]),
        started_at=row.started_at,
        finished_at=row.finished_at,
        error=told["error"],
        failure=told["failure"],
        result_id=result_id,
    )


def _sessions_read(call: Call, row: JobRow) -> list[UUID]:
    sources = [UUID(each["source"]) for each in row.inputs if each.get("role") != "result"]
    found = list(call.db.scalars(select(Recording.session_id).where(Recording.id.in_(sources)).distinct()))
    return found if row.session_id is None or row.session_id in found else [*found, row.session_id]


def _one(call: Call, row: JobRow) -> Job:
    return _answer(call, row, call.db.scalar(select(Result.id).where(Result.job_id == row.id)))


@router.get("")
def list_analyses(call: Reader, which: Annotated[JobFilter, Query()]) -> Page[Job]:
    """Jobs on visible patients, newest first; administrators see the queue of everyone."""
    query = select(JobRow, Result.id).outerjoin(Result, Result.job_id == JobRow.id)
    query = query.where(visibility.visible_job(call.caller.sees_all))
    if which.patient_id is not None:
        reads = aliased(JobPatient)
        query = query.where(exists().where(reads.job_id == JobRow.id, reads.patient_id == which.patient_id))
    for column, value in (
        (JobRow.session_id, which.session_id),
        (JobRow.kind, which.kind),
        (JobRow.status, which.status),
    ):
        if value is not None:
            query = query.where(column == value)
    call.audit("list", "jobs", patient_id=which.patient_id)
    query = query.order_by(JobRow.created_at.desc(), JobRow.id)
    return page(call, query, which, lambda row: _answer(call, row[0], row[1]))


@router.post("", status_code=HTTPStatus.CREATED)
def create_analysis(call: Runner, body: NewJob, response: Response, key: RepetitionKey = None) -> Job:
    """Ask for a computation; an equal one that waits, runs or has succeeded is answered instead."""

    def make() -> Job:
        job, fresh = order(call, body)
        for patient_id in visibility.patients_of(call, job.id):
            call.audit("analyse", "jobs", job.id, patient_id, {"kind": body.kind, "new": fresh})
        return _one(call, job)

    made = once(call, key, ("createAnalysis", body), Job, make)
    response.headers["Location"] = f"/api/v1/analyses/{made.id}"
    return made


@router.get("/{analysis_id}")
def get_analysis(call: Reader, analysis_id: UUID) -> Job:
    """One job."""
    return _one(call, visibility.job(call, analysis_id, "read"))


@router.post("/{analysis_id}/cancel")
def cancel_analysis(call: Runner, analysis_id: UUID) -> Job:
    """End a job: a waiting one at once, the process of a running one within 2 s."""
    job = visibility.job(call, analysis_id, "analyse")
    if not queue.cancel(call.db, job.id):
        raise Conflict(f"the job is over ({job.status}), so there is nothing to cancel")
    call.db.refresh(job)
    return _one(call, job)


@router.post("/{analysis_id}/retry", status_code=HTTPStatus.CREATED)
def retry_analysis(call: Runner, analysis_id: UUID) -> Job:
    """The same job once more."""
    job = visibility.job(call, analysis_id, "analyse")
    if job.status not in (JobStatus.FAILED, JobStatus.CANCELLED):
        raise Conflict(f"the job is {job.status}; only one that failed or was cancelled is tried again")
    return _one(call, again(call, job))


@router.put("/{analysis_id}/priority")
def set_priority(call: Manager, analysis_id: UUID, body: PriorityChange) -> Job:
    """Move a waiting job forwards or backwards in the queue."""
    job = visibility.job(call, analysis_id, "update")
    queue.set_priority(call.db, job.id, body.priority)
    call.db.refresh(job)
    return _one(call, job)


@router.get("/{analysis_id}/events", response_class=StreamingResponse, responses=EVENTS)
async def watch_analysis(asker: Listener, analysis_id: UUID) -> StreamingResponse:
    """Server-sent events: `job` (the whole job) at the beginning and the end, `progress` in between."""
    await run_in_threadpool(_look, asker, analysis_id, "read")
    headers = {"cache-control": "no-store", "x-accel-buffering": "no"}
    return StreamingResponse(_events(asker, analysis_id), media_type="text/event-stream", headers=headers)


def _look(asker: Asker, analysis_id: UUID, action: str) -> Job:
    with asker.begin() as call:
        return _one(call, visibility.job(call, analysis_id, action))


async def _events(asker: Asker, analysis_id: UUID) -> AsyncIterator[str]:
    async with asker.services.events.subscribe(analysis_id) as news:
        job = await run_in_threadpool(_look, asker, analysis_id, "read")
        yield _event("job", job.model_dump_json())
        while job.status not in FINAL:
            try:
                told = await asyncio.wait_for(news.get(), KEEP_ALIVE)
            except TimeoutError:
                yield ": still here\n\n"
                continue
            if "progress" in told and asker.caller.sees_names:
                yield _event("progress", json.dumps({"status": told["status"], **told["progress"]}))
            else:
                job = await run_in_threadpool(_look, asker, analysis_id, "read")
                yield _event("job", job.model_dump_json())


def _event(name: str, data: str) -> str:
    return f"event: {name}\ndata: {data}\n\n"
