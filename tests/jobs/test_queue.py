"""Asking for jobs: durable with the caller's transaction, and never twice for the same input."""

from dataclasses import replace
from uuid import uuid4

import pytest
from job_requests import job_of, request_of, submit_job
from sqlalchemy import func, select, text
from stored import make_visit

from gaitlab.errors import NotFound
from gaitlab.jobs.queue import cancel, set_priority, submit
from gaitlab.storage.models import Job, JobKind, JobPatient, JobStatus

QUEUE = text("SELECT queue_name, priority, args ->> 'job_id', status::text FROM procrastinate_jobs ORDER BY id")


def queue(database):
    with database.sessions() as session:
        return [tuple(row) for row in session.execute(QUEUE)]


def test_row_and_place_in_the_queue_come_together(database, store):
    visit = make_visit(database, store)
    quick = submit_job(database, visit, JobKind.INSPECT, priority=3)
    solve = submit_job(database, visit)
    assert queue(database) == [("quick", 3, str(quick), "todo"), ("solve", 0, str(solve), "todo")]


def test_nothing_is_asked_for_when_the_transaction_fails(database, store):
    visit = make_visit(database, store)
    with pytest.raises(ZeroDivisionError), database.transaction() as session:
        submit(session, request_of(visit))
        raise ZeroDivisionError
    assert queue(database) == []


@pytest.mark.parametrize("status", [JobStatus.QUEUED, JobStatus.RUNNING, JobStatus.SUCCEEDED])
def test_an_equal_job_is_found(database, store, status):
    request = request_of(make_visit(database, store))
    with database.transaction() as session:
        first, new = submit(session, request)
        first.status = status
    with database.transaction() as session:
        second, again = submit(session, replace(request, created_by=None))
    assert (new, again) == (True, False)
    assert second.id == first.id
    assert len(queue(database)) == 1


@pytest.mark.parametrize("status", [JobStatus.FAILED, JobStatus.CANCELLED])
def test_a_job_that_failed_may_be_asked_for_again(database, store, status):
    request = request_of(make_visit(database, store))
    with database.transaction() as session:
        submit(session, request)[0].status = status
    with database.transaction() as session:
        assert submit(session, request)[1]


def test_the_patients_of_a_job_are_known(database, store):
    visit = make_visit(database, store)
    submit_job(database, visit)
    with database.sessions() as session:
        assert list(session.scalars(select(JobPatient.patient_id))) == [visit.patient_id]
        assert session.scalar(select(func.count()).select_from(Job)) == 1


def test_a_waiting_job_is_cancelled_at_once_and_only_once(database, store):
    job_id = submit_job(database, make_visit(database, store))
    with database.transaction() as session:
        assert cancel(session, job_id)
    assert job_of(database, job_id).status is JobStatus.CANCELLED
    with database.transaction() as session:
        assert not cancel(session, job_id)
        with pytest.raises(NotFound, match="job"):
            cancel(session, uuid4())


def test_a_running_job_is_asked_to_end(database, store):
    job_id = submit_job(database, make_visit(database, store))
    with database.transaction() as session:
        session.get(Job, job_id).status = JobStatus.RUNNING
    with database.transaction() as session:
        assert cancel(session, job_id)
    job = job_of(database, job_id)
    assert (job.status, job.cancel_requested) == (JobStatus.RUNNING, True)


def test_a_waiting_job_moves_in_the_queue(database, store):
    job_id = submit_job(database, make_visit(database, store))
    with database.transaction() as session:
        set_priority(session, job_id, 9)
    assert queue(database)[0][1] == 9
    assert job_of(database, job_id).priority == 9
