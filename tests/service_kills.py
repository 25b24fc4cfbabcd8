"""A whole service whose processes are killed at random while it computes: nothing may be lost, nothing done twice."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import psutil
from job_requests import submit_job
from sqlalchemy import func, select
from sqlalchemy.exc import DBAPIError
from stored import make_visit, open_folder

from gaitlab.errors import StorageError
from gaitlab.storage.database import Database
from gaitlab.storage.embedded import EmbeddedPostgres
from gaitlab.storage.files import open_store
from gaitlab.storage.models import (
    FINAL,
    Job,
    JobKind,
    JobStatus,
    Result,
)
from gaitlab.storage.settings import Settings

VICTIMS = {
    "web": "gaitlab.cli.web_process",
    "worker": "gaitlab.cli.worker_process",
    "computation": "gaitlab.jobs.computing_process",
}
SERVE = "from gaitlab.cli import main; main()"
ATTEMPTS = 10_000
"""Far more than the 3 of an installation: here every loss is the killer's fault, never the job's."""


@dataclass
class Report:
    """What the kills did."""

    kills: Counter = field(default_factory=Counter)
    statuses: Counter = field(default_factory=Counter)
    interrupted: int = 0
    """Jobs that needed more than one attempt."""
    results: int = 0
    twice: int = 0
    damaged: int = 0
    seconds: float = 0.0


class Service:
    """`gaitlab serve` in a process, and a connection to its database."""

    def __init__(self, port=0):
        self.folder, self.port = open_folder(), port
        self.data = self.folder / "data"
        self.process = None
        self.server = EmbeddedPostgres(self.data)
        environment = {
            "GAITLAB_ATTEMPTS": str(ATTEMPTS), "GAITLAB_HEARTBEAT_SECONDS": "1", "GAITLAB_STALLED_SECONDS": "4",
            "GAITLAB_JOB_NICENESS": "0",
        }  # fmt: skip
        self.environment = os.environ | environment

    def start(self):
        """Start the service on its folder."""
        words = ["serve", "--data-dir", str(self.data), "--port", str(self.port)]
        with (self.folder / "log").open("ab") as log:
            self.process = subprocess.Popen([sys.executable, "-c", SERVE, *words], env=self.environment, stderr=log)

    def database(self):
        """Wait for the database, and open it."""
        while True:
            database = None
            try:
                if self.server.pid() is None:
                    raise StorageError("not yet")
                database = Database.open(self.server.url)
                database.check()
                with database.sessions() as session:
                    session.scalar(select(func.count()).select_from(Job))
                return database
            except (StorageError, DBAPIError, OSError):
                if database is not None:
                    database.close()
                time.sleep(0.2)

    def victim(self, kind):
        """A process to kill, or None."""
        if kind == "postgres":
            return self.server.pid()
        family = psutil.Process(self.process.pid).children(recursive=True)
        found = [each.pid for each in family if runs(each, VICTIMS[kind])]
        return found[0] if found else None

    def stop(self):
        """End the service in order."""
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(60)

    def remove(self):
        """Forget the folder."""
        shutil.rmtree(self.folder, ignore_errors=True)


def runs(process, module):
    try:
        return module in process.cmdline() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.Error:
        return False


@dataclass(frozen=True)
class Plan:
    """What is computed, and how often something is killed meanwhile."""

    kills: int
    inspections: int
    analyses: int
    """Of the clinical part only: angles, events, kinetics, scores."""
    solves: int
    """Analyses with everything, the walk and its weights included."""
    pause: tuple[float, float]
    """Shortest and longest time between two kills [s]."""
    deadline: float
    """Longest time for all of it [s]."""
    seed: int = 0
    """Of what is killed and when."""

    @property
    def jobs(self):
        return self.inspections + self.analyses + self.solves


def submit_jobs(database, store, files, plan):
    """Upload recordings and ask for jobs; returns the digests of what was acknowledged."""
    digests = []
    wanted = [(JobKind.ANALYSE, {})] * plan.solves + [(JobKind.ANALYSE, {"weights": False})] * plan.analyses
    # One after the other of each sort, so that kills hit all of them.
    random.Random(plan.seed).shuffle(wanted := wanted + [(JobKind.INSPECT, {})] * plan.inspections)
    for number, (kind, settings) in enumerate(wanted):
        contents = [(path.name, path.read_bytes()) for path in files[: None if kind is JobKind.ANALYSE else 1]]
        visit = make_visit(database, store, contents, f"P{number:04d}")
        submit_job(database, visit, kind, settings=settings)
        digests += [each.sha256 for each in visit.recordings]
    return digests


def kill_at_random(files, plan):
    """Run the jobs while processes are killed; `files`: recordings of an analysis, the static trial first."""
    begin, choice, report = time.monotonic(), random.Random(plan.seed), Report()
    service = Service()
    service.start()
    try:
        database = service.database()
        store = open_store(Settings(data_dir=service.data))
        digests = submit_jobs(database, store, files, plan)
        while time.monotonic() - begin < plan.deadline:
            unfinished = count_unfinished(database)
            if unfinished == 0 and report.kills.total() >= plan.kills:
                break
            if report.kills.total() < plan.kills:
                pid = service.victim(kind := choice.choice([*VICTIMS, "postgres"]))
                if pid is not None:
                    kill(pid)
                    report.kills[kind] += 1
            time.sleep(choice.uniform(*plan.pause))
        summarise(database, store, digests, report)
        database.close()
    finally:
        service.stop()
        service.remove()
    report.seconds = time.monotonic() - begin
    return report


def kill(pid):
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def count_unfinished(database):
    try:
        with database.sessions() as session:
            return session.scalar(select(func.count()).select_from(Job).where(Job.status.not_in(FINAL)))
    except DBAPIError:
        return None


def summarise(database, store, digests, report):
    """Count jobs, results and files at the end."""
    with database.sessions() as session:
        report.statuses.update(status.value for status in session.scalars(select(Job.status)))
        report.results = session.scalar(select(func.count()).select_from(Result))
        report.twice = report.results - session.scalar(select(func.count(Result.job_id.distinct())))
        again = select(func.count()).select_from(Job).where(Job.attempt > 1)
        report.interrupted = session.scalar(again)
        done = session.scalar(select(func.count()).select_from(Job).where(Job.status == JobStatus.SUCCEEDED))
    report.twice += abs(report.results - done)
    for digest in set(digests):
        try:
            store.read(digest)
        except StorageError:
            report.damaged += 1


def demo_files():
    """Recordings of the demo child: static trial and a walk."""
    folder = next((Path(__file__).parent.parent / "data").glob("**/demo_cp_child"))
    return [folder / "static.c3d", folder / "walk1.c3d"]
