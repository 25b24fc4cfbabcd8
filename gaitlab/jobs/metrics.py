"""Numbers for Prometheus: what this process did, and what the database says of all jobs."""

from collections.abc import Iterator

from prometheus_client import CollectorRegistry, Counter, Histogram
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.registry import Collector
from sqlalchemy import func, select, text
from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from ..storage.database import Database
from ..storage.models import Job, JobKind, JobStatus

BUCKETS = (0.5, 1, 2, 5, 10, 30, 60, 300, 900, 3600, 14400)

JOBS = Counter("gaitlab_jobs_ended", "Jobs that this worker brought to an end", ["kind", "status"])
PROCESS_SECONDS = Histogram("gaitlab_process_seconds", "Life of computing processes [s]", ["kind"], buckets=BUCKETS)
TAKEN_OVER = Counter("gaitlab_jobs_taken_over", "Stalled jobs that this worker gave back to the queue")

WORKERS = text("SELECT count(*) FROM procrastinate_workers WHERE last_heartbeat > now() - make_interval(secs => 60)")
QUEUES_PER_WORKER = 2
"""Each worker opens the queue twice: for quick jobs and for computations."""
LONGEST_WAIT = text("SELECT coalesce(extract(epoch FROM now() - min(created_at)), 0) FROM jobs WHERE status = 'queued'")


def alive_workers(session: Session) -> int:
    """Workers that showed life within the last minute."""
    return int(session.scalar(WORKERS) or 0) // QUEUES_PER_WORKER


def gauges_of(database: Database) -> CollectorRegistry:
    """Numbers of a database, for one place to ask for them: the web server, not each of the workers."""
    registry = CollectorRegistry()
    registry.register(JobGauges(database))
    return registry


class JobGauges(Collector):
    """Jobs by kind and status, failures by their kind, and workers, counted in the database at every scrape."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def collect(self) -> Iterator[GaugeMetricFamily]:
        """The gauges; none while the database is away."""
        try:
            with self._database.sessions() as session:
                gauges = [_jobs(session), _failures(session), *_queue(session)]
        except DBAPIError:
            return
        yield from gauges


def _jobs(session: Session) -> GaugeMetricFamily:
    # Zeros, too: a number that vanishes with the last job of its kind raises no alarm.
    counts = dict.fromkeys(((kind, status) for kind in JobKind for status in JobStatus), 0)
    for kind, status, count in session.execute(
        select(Job.kind, Job.status, func.count()).group_by(Job.kind, Job.status)
    ):
        counts[kind, status] = count
    gauge = GaugeMetricFamily("gaitlab_jobs", "Jobs by kind and status", labels=["kind", "status"])
    for (kind, status), count in counts.items():
        gauge.add_metric([kind.value, status.value], count)
    return gauge


def _failures(session: Session) -> GaugeMetricFamily:
    gauge = GaugeMetricFamily("gaitlab_jobs_failed", "Failed jobs by kind and reason", labels=["kind", "failure"])
    reason = Job.failure["kind"].astext
    failed = select(Job.kind, reason, func.count()).where(Job.status == JobStatus.FAILED)
    for kind, failure, count in session.execute(failed.group_by(Job.kind, reason)):
        gauge.add_metric([kind.value, failure or "unknown"], count)
    return gauge


def _queue(session: Session) -> Iterator[GaugeMetricFamily]:
    yield GaugeMetricFamily(
        "gaitlab_longest_wait_seconds",
        "Time since the oldest waiting job was asked for [s]",
        value=float(session.scalar(LONGEST_WAIT) or 0.0),
    )
    yield GaugeMetricFamily("gaitlab_workers", "Workers that showed life", value=alive_workers(session))
