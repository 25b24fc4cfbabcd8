"""Kills at random: no job is lost, none has two results, every upload is intact."""

import os
import subprocess
import sys
import time

import pytest
from job_requests import job_of, submit_job
from service_kills import Plan, demo_files, kill_at_random
from stored import make_visit

from gaitlab.storage.models import JobStatus

PLAN = Plan(kills=20, inspections=8, analyses=2, solves=0, pause=(0.5, 4.0), deadline=1500.0)
TAKEN_OVER_SECONDS = 30.0
WORKER = """
import asyncio, sys
from pathlib import Path
from gaitlab.jobs.worker import Worker
from gaitlab.storage.database import Database
from gaitlab.storage.files import FileStore
from gaitlab.storage.objects import DiskObjects
from gaitlab.storage.settings import Settings

url, data, files = sys.argv[1:]
objects = DiskObjects(Path(files))
worker = Worker(Settings(data_dir=Path(data)), Database.open(url), FileStore(objects, objects.spool))
worker.runner.module = "toy_process"

async def main():
    await worker.run()

asyncio.run(main())
"""


@pytest.mark.slow
def test_nothing_is_lost_or_done_twice_when_processes_are_killed():
    report = kill_at_random(demo_files(), PLAN)
    assert report.kills.total() == PLAN.kills and report.interrupted > 0
    assert report.statuses == {"succeeded": PLAN.jobs}
    assert (report.results, report.twice, report.damaged) == (PLAN.jobs, 0, 0)


@pytest.mark.slow
def test_a_job_moves_to_the_other_worker_when_its_own_is_killed(database, store, toy, tmp_path):
    job_id = submit_job(database, make_visit(database, store), settings={"do": "hang"})
    workers = {}

    def start():
        command = [sys.executable, "-c", WORKER, database.url, str(tmp_path / "data"), str(tmp_path / "files")]
        process = subprocess.Popen(command, env=os.environ, stderr=subprocess.DEVNULL)
        workers[process.pid] = process

    start()
    while not job_of(database, job_id).progress:
        time.sleep(0.1)
    start()
    first = job_of(database, job_id)
    # Both workers are there before one is killed.
    time.sleep(5.0)
    workers[int(first.worker.split("-")[-2])].kill()
    killed = time.monotonic()
    while (job := job_of(database, job_id)).attempt == 1 and time.monotonic() - killed < 2 * TAKEN_OVER_SECONDS:
        time.sleep(0.1)
    seconds = time.monotonic() - killed
    for process in workers.values():
        process.terminate()
        process.wait()
    assert (job.attempt, job.status) == (2, JobStatus.RUNNING)
    assert job.worker != first.worker
    assert seconds < TAKEN_OVER_SECONDS
