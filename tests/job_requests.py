"""Jobs for tests."""

from gaitlab.jobs.queue import submit
from gaitlab.jobs.request import JobInput, JobRequest
from gaitlab.storage.models import Job, JobKind


def request_of(visit, kind=JobKind.ANALYSE, **more):
    """A job on the recordings of a visit."""
    inputs = tuple(
        JobInput(
            role="recording" if kind is JobKind.INSPECT else each.kind.value,
            name=each.name,
            sha256=each.sha256,
            source=each.id,
        )
        for each in visit.recordings
    )
    settings = more.pop("settings", {})
    return JobRequest(
        kind=kind,
        inputs=inputs,
        patients=frozenset({visit.patient_id}),
        session_id=visit.session_id,
        settings=settings,
        **more,
    )


def submit_job(database, visit, kind=JobKind.ANALYSE, **more):
    """Id of a new job."""
    with database.transaction() as session:
        return submit(session, request_of(visit, kind, **more))[0].id


def job_of(database, job_id):
    """The job's row."""
    with database.sessions() as session:
        return session.get(Job, job_id)
