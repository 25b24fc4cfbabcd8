"""Numbers for Prometheus, of this process."""

from collections.abc import Iterator

from prometheus_client import Counter, Histogram
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.registry import Collector
from sqlalchemy import func, select
from sqlalchemy.exc import DBAPIError

from ..storage.database import Database
from ..storage.models import Job

BUCKETS = (0.5, 1, 2, 5, 10, 30, 60, 300, 900, 3600, 14400)

JOBS = Counter("gaitlab_jobs_ended", "Jobs that this worker brought to an end", ["kind", "status"])
PROCESS_SECONDS = Histogram("gaitlab_process_seconds", "Life of computing processes [s]", ["kind"], buckets=BUCKETS)
TAKEN_OVER = Counter("gaitlab_jobs_taken_over", "Stalled jobs that this worker gave back to the queue")


class JobGauges(Collector):
    """Jobs by kind and status, counted in the database at every scrape."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def collect(self) -> Iterator[GaugeMetricFamily]:
        """One gauge; none while the database is away."""
        gauge = GaugeMetricFamily("gaitlab_jobs", "Jobs by kind and status", labels=["kind", "status"])
        try:
            with self._database.sessions() as session:
                for kind, status, count in session.execute(
                    select(Job.kind, Job.status, func.count()).group_by(Job.kind, Job.status)
                ):
                    gauge.add_metric([kind.value, status.value], count)
        except DBAPIError:
            return
        yield gauge
