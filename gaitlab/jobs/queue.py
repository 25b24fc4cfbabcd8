"""Asking for jobs: the row and its place in procrastinate's queue are made in one transaction."""

from typing import Any
from uuid import UUID

from procrastinate import App, SyncPsycopgConnector
from sqlalchemy import func, select, text, update
from sqlalchemy.orm import Session

from ..errors import NotFound
from ..storage.models import Job, JobPatient, JobStatus
from .claims import request_cancel
from .request import QUEUES, JobRequest

TASK = "gaitlab.run"
"""The one task of the queue; its argument is the job's id."""
LIVE = (JobStatus.QUEUED, JobStatus.RUNNING, JobStatus.SUCCEEDED)

PRIORITY = text("""
UPDATE procrastinate_jobs SET priority = :priority
WHERE status = 'todo' AND id = (SELECT queue_job_id FROM jobs WHERE id = :id)
""")

_app = App(connector=SyncPsycopgConnector())


def submit(session: Session, request: JobRequest) -> tuple[Job, bool]:
    """Ask for a job in the caller's transaction.

    Returns:
        The job, and whether it is new: an equal one that waits, runs or has succeeded is returned as it is.
    """
    # Two equal requests at the same time: the second waits here for the first.
    session.execute(select(func.pg_advisory_xact_lock(int(request.input_hash[:15], 16))))
    same = select(Job).where(Job.kind == request.kind, Job.input_hash == request.input_hash, Job.status.in_(LIVE))
    present = session.scalars(same).first()
    if present is not None:
        return present, False
    job = add_job(session, request)
    enqueue(session, job)
    session.flush()
    return job, True


def add_job(session: Session, request: JobRequest, **state: Any) -> Job:
    """The rows of a request, in no queue yet; `state` are further columns of the job."""
    job = Job(
        kind=request.kind,
        input_hash=request.input_hash,
        session_id=request.session_id,
        created_by=request.created_by,
        inputs=[each.as_json() for each in request.inputs],
        settings=dict(request.settings),
        priority=request.priority,
        request_id=request.request_id,
        **state,
    )
    session.add(job)
    session.flush()
    session.add_all(JobPatient(job_id=job.id, patient_id=patient) for patient in request.patients)
    return job


def enqueue(session: Session, job: Job) -> None:
    """Give the job a new place in the queue, in the caller's transaction."""
    connection: Any = session.connection().connection.driver_connection
    deferrer = _app.configure_task(TASK, queue=QUEUES[job.kind], priority=job.priority, connection=connection)
    job.queue_job_id = deferrer.defer(job_id=str(job.id))


def cancel(session: Session, job_id: UUID) -> bool:
    """Ask for the end of a job: a waiting one is cancelled at once, the process of a running one ends within 2 s.

    Returns:
        False if it was over already.

    Raises:
        NotFound: There is no such job.
    """
    job = session.get(Job, job_id)
    if job is None:
        raise NotFound("job", str(job_id), ())
    return request_cancel(session, job)


def set_priority(session: Session, job_id: UUID, priority: int) -> None:
    """Move a waiting job forwards or backwards; higher first."""
    session.execute(update(Job).where(Job.id == job_id).values(priority=priority))
    session.execute(PRIORITY, {"id": job_id, "priority": priority})
