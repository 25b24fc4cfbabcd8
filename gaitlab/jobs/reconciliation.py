"""Jobs that lost their worker: found by any other worker, and given back to the queue.

procrastinate does not take over what a dead worker left. A job is lost when its place in the queue is given out and
neither its start nor its heartbeat is recent, or when it waits or runs and its place in the queue is used up.
"""

from dataclasses import dataclass

from sqlalchemy import select, text
from sqlalchemy.orm import Session

from ..storage.database import Database
from ..storage.models import Job
from . import metrics
from .queue import enqueue

STALLED = text("""
SELECT q.id FROM procrastinate_jobs AS q LEFT JOIN jobs ON jobs.queue_job_id = q.id
WHERE q.status = 'doing' AND greatest(
    jobs.heartbeat_at,
    (SELECT max(at) FROM procrastinate_events AS e WHERE e.job_id = q.id AND e.type = 'started')
) < now() - make_interval(secs => :seconds)
FOR UPDATE OF q SKIP LOCKED
""")
GIVE_BACK = text("SELECT procrastinate_retry_job_v2(:id, now(), NULL, NULL, NULL)")
"""procrastinate's own function, as `JobManager.retry_job_by_id` calls it."""
ORPHANS = text("""
SELECT jobs.id FROM jobs LEFT JOIN procrastinate_jobs AS q ON q.id = jobs.queue_job_id
WHERE jobs.status IN ('queued', 'running') AND (q.id IS NULL OR q.status NOT IN ('todo', 'doing'))
    AND coalesce(jobs.heartbeat_at, jobs.created_at) < now() - make_interval(secs => :seconds)
FOR UPDATE OF jobs SKIP LOCKED
""")


@dataclass(frozen=True, kw_only=True)
class Recovered:
    """What was given back."""

    stalled: int
    orphans: int


def recover(database: Database, seconds: float) -> Recovered:
    """Give back every job without a sign of life for so long [s]. Any number of workers may do it at a time."""
    with database.transaction() as session:
        stalled = list(session.scalars(STALLED, {"seconds": seconds}))
        for queue_id in stalled:
            session.execute(GIVE_BACK, {"id": queue_id})
        orphans = _enqueue_orphans(session, seconds)
    metrics.TAKEN_OVER.inc(len(stalled) + orphans)
    return Recovered(stalled=len(stalled), orphans=orphans)


def _enqueue_orphans(session: Session, seconds: float) -> int:
    ids = list(session.scalars(ORPHANS, {"seconds": seconds}))
    for job in session.scalars(select(Job).where(Job.id.in_(ids))):
        enqueue(session, job)
    return len(ids)
