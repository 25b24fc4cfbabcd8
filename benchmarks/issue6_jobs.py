"""Issue 6, line 1: how soon a cancelled analysis is dead, and how soon another worker has a dead one's job."""

import os
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import psutil
from job_requests import job_of, submit_job
from registry import Row, measurement
from service_kills import demo_files
from stored import make_visit, new_database, open_folder, template, url_of
from whole_service import GAITLAB, WholeService

from gaitlab.storage.database import Database
from gaitlab.storage.files import open_store
from gaitlab.storage.settings import Settings

TRIES = 5
LONGEST = 120.0


@measurement(issue=6, line=1)
def cancelling_an_analysis() -> Iterator[Row]:
    service = WholeService(open_folder() / "data", "--concurrency", "1")
    service.start()
    service.make_first_account()
    dead: list[float] = []
    try:
        for _ in range(TRIES):
            job_id = service.order_analysis()
            process = service.compute(job_id)
            begin = time.perf_counter()
            service.client.post(f"/api/v1/analyses/{job_id}/cancel").raise_for_status()
            process.wait(LONGEST)
            dead.append(time.perf_counter() - begin)
            service.wait(lambda job_id=job_id: service.job(job_id)["status"] == "cancelled")
    finally:
        service.stop()
    yield Row(
        quantity="request until the process is dead, worst", value=max(dead), limit="<= 2", unit="s",
        subject=f"{TRIES} analyses",
    )  # fmt: skip


def _worker(stack: ExitStack, url: str, data: Path) -> "subprocess.Popen[bytes]":
    command = [str(GAITLAB), "worker", "--data-dir", str(data), "--files", str(data.parent / "files")]
    environment = os.environ | {"GAITLAB_DATABASE_URL": url}
    process = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
    stack.callback(process.kill)
    return process


def _wait(look: Any) -> Any:
    deadline = time.monotonic() + LONGEST
    while not (found := look()):
        if time.monotonic() > deadline:
            raise TimeoutError("the workers do not what they should")
        time.sleep(0.05)
    return found


@measurement(issue=6, line=1)
def takeover_by_another_worker() -> Iterator[Row]:
    folder = open_folder()
    database = Database.open(url_of(new_database(template())))
    store = open_store(Settings(data_dir=folder, files=str(folder / "files")))
    contents = [(path.name, path.read_bytes()) for path in demo_files()]
    seconds: list[float] = []
    with ExitStack() as stack:
        workers = [_worker(stack, database.url, folder / f"worker{number}") for number in range(2)]
        for number in range(TRIES):
            job_id = submit_job(database, make_visit(database, store, contents, f"P{number}"))
            _wait(lambda job_id=job_id: job_of(database, job_id).progress)
            first = job_of(database, job_id)
            (owner,) = [each for each in workers if first.worker.split("-")[-2] == str(each.pid)]
            computing = psutil.Process(owner.pid).children(recursive=True)
            owner.kill()
            begin = time.perf_counter()
            _wait(lambda job_id=job_id, before=first.attempt: job_of(database, job_id).attempt > before)
            seconds.append(time.perf_counter() - begin)
            assert psutil.wait_procs(computing, LONGEST)[1] == []
            with database.transaction() as session:
                # Out of the way of the next try.
                job = session.merge(job_of(database, job_id))
                job.cancel_requested = True
            owner.wait()
            workers[workers.index(owner)] = _worker(stack, database.url, folder / f"again{number}")
    database.close()
    yield Row(
        quantity="kill -9 until the other worker has it, worst", value=max(seconds), limit="<= 30", unit="s",
        subject=f"{TRIES} analyses",
    )  # fmt: skip
