"""Steps in the life of a job's row. Every step names its attempt: one that was superseded changes nothing.

queued -> running -> succeeded | failed | cancelled, and from running back to queued after a loss or a shutdown.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy import Text, bindparam, text
from sqlalchemy.dialects.postgresql import JSONB
from sqlalchemy.orm import Session

from ..storage.models import Job, JobStatus
from .events import announce
from .supervision import Verdict

CLAIM = text("""
UPDATE jobs SET status = 'running', attempt = attempt + 1, worker = :worker, progress = '{}', heartbeat_at = now(),
    started_at = now(), losses = losses + CASE WHEN status = 'running' THEN 1 ELSE 0 END
WHERE id = :id AND status IN ('queued', 'running')
RETURNING attempt, losses, cancel_requested
""")
"""A job that is still running although the queue gave it out again has lost its worker."""

BEAT = text("""
UPDATE jobs SET heartbeat_at = now(), progress = coalesce(:progress, progress)
WHERE id = :id AND attempt = :attempt AND status = 'running'
RETURNING cancel_requested
""").bindparams(bindparam("progress", type_=JSONB(none_as_null=True)))

END = text("""
UPDATE jobs SET status = :status, finished_at = now(), error = :error, failure = :failure, heartbeat_at = NULL
WHERE id = :id AND attempt = :attempt AND status = 'running'
RETURNING id
""").bindparams(bindparam("failure", type_=JSONB(none_as_null=True)), bindparam("error", type_=Text()))

REQUEUE = text("""
UPDATE jobs SET status = 'queued', losses = losses + :lost, failure = coalesce(:failure, failure), heartbeat_at = NULL
WHERE id = :id AND attempt = :attempt AND status = 'running'
RETURNING losses
""").bindparams(bindparam("failure", type_=JSONB(none_as_null=True)))


@dataclass(frozen=True, kw_only=True)
class Claim:
    """The right to compute a job, until somebody else claims it."""

    job_id: UUID
    attempt: int
    losses: int
    cancelled: bool
    """Whether it was cancelled before it began."""

    @property
    def key(self) -> dict[str, Any]:
        """What every statement names."""
        return {"id": self.job_id, "attempt": self.attempt}


def claim(session: Session, job_id: UUID, worker: str) -> Claim | None:
    """Begin a new attempt; None if the job is over or was deleted."""
    row = session.execute(CLAIM, {"id": job_id, "worker": worker}).one_or_none()
    if row is None:
        return None
    announce(session, job_id, JobStatus.RUNNING)
    return Claim(job_id=job_id, attempt=row.attempt, losses=row.losses, cancelled=row.cancel_requested)


def beat(session: Session, claimed: Claim, progress: Mapping[str, Any] | None) -> Verdict:
    """Show life and progress, and learn whether to go on."""
    row = session.execute(BEAT, {**claimed.key, "progress": progress}).one_or_none()
    if row is None:
        return Verdict.SUPERSEDED
    if progress is not None:
        announce(session, claimed.job_id, JobStatus.RUNNING, progress)
    return Verdict.CANCEL if row.cancel_requested else Verdict.GO_ON


def end(
    session: Session, claimed: Claim, status: JobStatus, error: str = "", failure: Mapping[str, Any] | None = None
) -> bool:
    """Bring the job to a final state; False if the attempt was superseded."""
    values = {**claimed.key, "status": status.value, "error": error, "failure": failure}
    if session.execute(END, values).one_or_none() is None:
        return False
    announce(session, claimed.job_id, status)
    return True


def requeue(session: Session, claimed: Claim, failure: Mapping[str, Any] | None, lost: bool) -> bool:
    """Let the job wait for its next attempt; `lost`: this one counts. False if the attempt was superseded."""
    row = session.execute(REQUEUE, {**claimed.key, "failure": failure, "lost": int(lost)}).one_or_none()
    if row is None:
        return False
    announce(session, claimed.job_id, JobStatus.QUEUED)
    return True


def request_cancel(session: Session, job: Job) -> bool:
    """Ask for the end of a job; a waiting one ends at once. False if it was over already."""
    session.refresh(job, with_for_update=True)
    if job.status is JobStatus.QUEUED:
        job.status, job.cancel_requested = JobStatus.CANCELLED, True
        announce(session, job.id, JobStatus.CANCELLED)
    elif job.status is JobStatus.RUNNING:
        job.cancel_requested = True
    else:
        return False
    session.flush()
    return True
