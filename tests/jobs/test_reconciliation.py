"""Jobs without a sign of life are given back, others are left alone."""

import pytest
from job_requests import job_of, submit_job
from sqlalchemy import text
from stored import make_visit

from gaitlab.jobs.claims import claim
from gaitlab.jobs.reconciliation import Recovered, recover
from gaitlab.storage.models import JobStatus

STALLED = 15.0
OLD = "now() - interval '20 seconds'"


@pytest.fixture
def taken(database, store):
    """Id of a job that a worker has taken and claimed."""
    job_id = submit_job(database, make_visit(database, store))
    with database.transaction() as session:
        session.execute(text("INSERT INTO procrastinate_workers DEFAULT VALUES"))
        worker = session.scalar(text("SELECT max(id) FROM procrastinate_workers"))
        session.execute(text("SELECT procrastinate_fetch_job_v2(NULL, :worker)"), {"worker": worker})
        claim(session, job_id, "test")
    return job_id


def age(database, *statements):
    with database.transaction() as session:
        for statement in statements:
            session.execute(text(statement))


def place(database):
    with database.sessions() as session:
        return session.scalar(text("SELECT status::text FROM procrastinate_jobs"))


def test_a_job_that_shows_life_stays_with_its_worker(database, taken):
    age(database, f"UPDATE procrastinate_events SET at = {OLD}")
    assert recover(database, STALLED) == Recovered(stalled=0, orphans=0)
    assert place(database) == "doing"


def test_a_job_that_was_just_taken_is_not_stalled(database, taken):
    age(database, f"UPDATE jobs SET heartbeat_at = {OLD}")
    assert recover(database, STALLED).stalled == 0


def test_a_silent_job_waits_again_and_counts_a_loss_when_it_is_claimed(database, taken):
    age(database, f"UPDATE jobs SET heartbeat_at = {OLD}", f"UPDATE procrastinate_events SET at = {OLD}")
    assert recover(database, STALLED) == Recovered(stalled=1, orphans=0)
    assert recover(database, STALLED).stalled == 0
    assert place(database) == "todo"
    with database.transaction() as session:
        assert claim(session, taken, "another").losses == 1


@pytest.mark.parametrize("loss", ["DELETE FROM procrastinate_jobs", "UPDATE procrastinate_jobs SET status = 'failed'"])
def test_a_job_without_a_place_in_the_queue_gets_a_new_one(database, taken, loss):
    age(
        database,
        "UPDATE procrastinate_periodic_defers SET job_id = NULL",
        loss,
        f"UPDATE jobs SET heartbeat_at = {OLD}",
    )
    assert recover(database, STALLED) == Recovered(stalled=0, orphans=1)
    with database.sessions() as session:
        waiting = session.scalar(text("SELECT id FROM procrastinate_jobs WHERE status = 'todo'"))
    assert job_of(database, taken).queue_job_id == waiting


def test_jobs_that_are_over_need_no_place(database, taken):
    age(database, "DELETE FROM procrastinate_jobs", f"UPDATE jobs SET heartbeat_at = {OLD}, status = 'succeeded'")
    assert recover(database, STALLED) == Recovered(stalled=0, orphans=0)
    assert job_of(database, taken).status is JobStatus.SUCCEEDED
