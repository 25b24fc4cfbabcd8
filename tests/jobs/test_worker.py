"""A whole worker: jobs in order of priority, an orderly end, an outage of the database, abandoned folders."""

import asyncio

import pytest
from job_requests import job_of, submit_job
from prometheus_client import CollectorRegistry, generate_latest
from sqlalchemy import text
from stored import make_visit

from gaitlab.jobs.events import EventBroker
from gaitlab.jobs.metrics import JobGauges
from gaitlab.jobs.worker import Worker
from gaitlab.jobs.workspace import LOCK, workspace
from gaitlab.storage.models import FINAL, Job, JobKind, JobStatus
from gaitlab.storage.settings import Settings

CUT = text(
    "SELECT pg_terminate_backend(pid) FROM pg_stat_activity "
    "WHERE datname = current_database() AND pid <> pg_backend_pid()"
)


@pytest.fixture
def worker(database, store, toy, tmp_path):
    settings = Settings(data_dir=tmp_path, job_memory=8_000_000_000, job_niceness=0, heartbeat_seconds=1.0)
    worker = Worker(settings, database, store)
    worker.runner.module = toy
    return worker


def status_of(database, job_id):
    return job_of(database, job_id).status


async def until(condition):
    while not condition():
        await asyncio.sleep(0.1)


async def work(worker, scenario):
    """Run a worker while the scenario lasts."""
    running = asyncio.create_task(worker.run())
    try:
        await asyncio.wait_for(scenario, 120.0)
    finally:
        worker.stop()
        await running


def test_jobs_run_by_priority_and_quick_ones_beside(worker, database, store):
    visit = make_visit(database, store)
    low, high = (submit_job(database, visit, settings={"n": n}, priority=n) for n in (0, 5))
    quick = submit_job(database, visit, JobKind.INSPECT, settings={"do": "describe"})
    jobs = (low, high, quick)
    asyncio.run(work(worker, until(lambda: all(status_of(database, each) in FINAL for each in jobs))))
    assert {status_of(database, each) for each in jobs} == {JobStatus.SUCCEEDED}
    assert job_of(database, high).finished_at < job_of(database, low).finished_at
    with database.sessions() as session:
        assert session.scalar(text("SELECT count(*) FROM procrastinate_jobs")) == 0


def test_a_stopped_worker_gives_its_job_back(worker, database, store):
    job_id = submit_job(database, make_visit(database, store), settings={"do": "hang"})
    asyncio.run(work(worker, until(lambda: job_of(database, job_id).progress)))
    job = job_of(database, job_id)
    assert (job.status, job.losses) == (JobStatus.QUEUED, 0)
    with database.sessions() as session:
        assert session.scalar(text("SELECT status::text FROM procrastinate_jobs")) == "todo"


def test_cut_connections_cost_nothing(worker, database, store):
    job_id = submit_job(database, make_visit(database, store), settings={"do": "hang", "seconds": 3})

    async def cut():
        await until(lambda: job_of(database, job_id).progress)
        for _ in range(3):
            with database.engine.connect() as connection:
                connection.execute(CUT)
            await asyncio.sleep(0.3)
        await until(lambda: status_of(database, job_id) in FINAL)

    asyncio.run(work(worker, cut()))
    job = job_of(database, job_id)
    assert (job.status, job.attempt) == (JobStatus.SUCCEEDED, 1)


def test_a_browser_hears_of_progress_and_end(worker, database, store):
    job_id = submit_job(database, make_visit(database, store), settings={"do": "hang", "seconds": 2})
    heard = []

    async def listen():
        broker = EventBroker(database.url)
        await broker.start()
        async with broker.subscribe(job_id) as news:
            while not heard or heard[-1].get("status") != "succeeded":
                heard.append(await news.get())
        await broker.stop()

    asyncio.run(work(worker, listen()))
    assert "hanging" in [each.get("progress", {}).get("stage") for each in heard]


def test_the_listener_returns_after_an_outage(database):
    async def listen():
        broker = EventBroker(database.url)
        await broker.start()
        job_id = job.id
        async with broker.subscribe(job_id) as news:
            with database.engine.connect() as connection:
                connection.execute(CUT)
            assert await asyncio.wait_for(news.get(), 20.0) == {"lost": True}
        await broker.stop()

    with database.transaction() as session:
        job = Job(kind=JobKind.INSPECT, input_hash="0" * 64)
        session.add(job)
    asyncio.run(listen())


def test_folders_of_dead_workers_are_removed_and_those_of_living_ones_kept(tmp_path):
    dead = tmp_path / "dead"
    dead.mkdir()
    (dead / LOCK).touch()
    (dead / "walk.c3d").touch()
    with workspace(tmp_path, "first") as first, workspace(tmp_path, "second") as second:
        assert not dead.exists()
        assert first.is_dir() and second.is_dir()
    assert list(tmp_path.iterdir()) == []


def test_metrics_count_jobs_by_kind_and_status(database, store):
    submit_job(database, make_visit(database, store))
    registry = CollectorRegistry()
    registry.register(JobGauges(database))
    assert b'gaitlab_jobs{kind="analyse",status="queued"} 1.0' in generate_latest(registry)
