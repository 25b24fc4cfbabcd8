"""The life of a job: computed, written once, tried again, given up."""

import asyncio
import time
from dataclasses import replace

import psutil
import pytest
from job_requests import job_of, submit_job
from sqlalchemy import func, select, update
from stored import make_visit

from gaitlab.jobs.claims import claim, end
from gaitlab.jobs.queue import cancel
from gaitlab.jobs.request import OWNER
from gaitlab.jobs.tasks import Runner, TryAgain
from gaitlab.storage.audit import SYSTEM
from gaitlab.storage.deletion import delete_patient
from gaitlab.storage.models import Job, JobKind, JobStatus, Recording, Result, ResultFile, StoredFile, Subject
from gaitlab.storage.settings import Settings


@pytest.fixture
def runner(database, store, toy, tmp_path):
    settings = Settings(data_dir=tmp_path, job_memory=8_000_000_000)
    return Runner(database=database, store=store, settings=settings, worker="test", workspace=tmp_path, module=toy)


@pytest.fixture
def visit(database, store):
    return make_visit(database, store)


def run(runner, job_id):
    asyncio.run(runner.run(job_id))
    return job_of(runner.database, job_id)


def results(database):
    with database.sessions() as session:
        return list(session.scalars(select(Result)))


def test_a_result_is_written_with_its_files_and_where_it_comes_from(runner, visit, database, store):
    job = run(runner, submit_job(database, visit, settings={"seed": 7}))
    (result,) = results(database)
    with database.sessions() as session:
        (file,) = session.scalars(select(ResultFile))
    assert (job.status, job.attempt, job.error) == (JobStatus.SUCCEEDED, 1, "")
    assert (file.name, file.media_type, store.read(file.sha256)) == ("trial/result.json", "application/json", b"walk")
    assert result.summary == {"answer": 42}
    assert result.provenance["seed"] == 7
    assert result.provenance["inputs"][0]["sha256"] == visit.recordings[0].sha256
    assert "gaitlab" in result.provenance["environment"]


def test_nothing_is_left_in_the_folder_of_jobs(runner, visit, database, tmp_path):
    run(runner, submit_job(database, visit))
    assert [path.name for path in tmp_path.iterdir() if path.name != "files"] == []


def test_a_job_that_is_over_is_not_computed_again(runner, visit, database):
    job_id = submit_job(database, visit)
    run(runner, job_id)
    assert run(runner, job_id).attempt == 1
    assert len(results(database)) == 1


def test_a_refused_input_fails_with_its_sentence(runner, visit, database):
    job = run(runner, submit_job(database, visit, settings={"do": "refuse"}))
    assert (job.status, job.error) == (JobStatus.FAILED, "walk.c3d: no markers")
    assert job.failure == {"kind": "refused", "error": "InvalidRecording"}


def test_a_native_crash_is_tried_again_and_then_recorded(runner, visit, database):
    job_id = submit_job(database, visit, settings={"do": "crash"})
    for losses in (1, 2):
        with pytest.raises(TryAgain):
            run(runner, job_id)
        job = job_of(database, job_id)
        assert (job.status, job.losses) == (JobStatus.QUEUED, losses)
    job = run(runner, job_id)
    assert (job.status, job.attempt) == (JobStatus.FAILED, 3)
    assert (job.failure["kind"], job.failure["signal"]) == ("crash", "SIGSEGV")
    assert "invalid pointer" in job.failure["stderr"]


def test_a_job_that_loses_its_worker_three_times_is_failed(runner, visit, database):
    job_id = submit_job(database, visit)
    for _ in range(3):
        with database.transaction() as session:
            claim(session, job_id, "a worker that dies")
    job = run(runner, job_id)
    assert (job.status, job.failure["kind"]) == (JobStatus.FAILED, "lost")
    assert "3 times" in job.error


def test_a_time_out_is_failed_at_once(runner, visit, database, tmp_path):
    runner = replace(runner, settings=Settings(data_dir=tmp_path, job_seconds=0.5))
    job = run(runner, submit_job(database, visit, settings={"do": "hang"}))
    assert (job.status, job.failure["kind"]) == (JobStatus.FAILED, "time_out")


def test_a_missing_file_is_said(runner, visit, database, store):
    store.delete(visit.recordings[0].sha256)
    job = run(runner, submit_job(database, visit))
    assert (job.status, job.failure["kind"]) == (JobStatus.FAILED, "storage")


def test_only_the_newest_attempt_may_end_a_job(visit, database):
    job_id = submit_job(database, visit)
    with database.transaction() as session:
        slow, fast = claim(session, job_id, "slow"), claim(session, job_id, "fast")
        assert not end(session, slow, JobStatus.SUCCEEDED)
        assert end(session, fast, JobStatus.SUCCEEDED)
        assert claim(session, job_id, "late") is None


async def during(runner, job_id, deed):
    """Run a job, and do something once it computes."""
    running = asyncio.create_task(runner.run(job_id))
    while not job_of(runner.database, job_id).progress:
        await asyncio.sleep(0.05)
    await asyncio.to_thread(deed)
    await running


def test_a_result_of_a_superseded_attempt_is_thrown_away(runner, visit, database, store):
    job_id = submit_job(database, visit, settings={"do": "hang", "seconds": 5})

    def supersede():
        with database.transaction() as session:
            claim(session, job_id, "another")

    asyncio.run(during(runner, job_id, supersede))
    assert results(database) == []
    assert [name for name, _ in store.names()] == [visit.recordings[0].sha256]
    assert job_of(database, job_id).worker == "another"


def test_cancelling_ends_a_running_job_within_two_seconds(runner, visit, database):
    job_id = submit_job(database, visit, settings={"do": "hang"})
    asked = []

    def ask():
        with database.transaction() as session:
            cancel(session, job_id)
        asked.append(time.monotonic())

    asyncio.run(during(runner, job_id, ask))
    assert job_of(database, job_id).status is JobStatus.CANCELLED
    assert time.monotonic() - asked[0] < 2.0


def test_files_of_an_attempt_that_comes_too_late_are_removed(runner, visit, database, store):
    job_id = submit_job(database, visit, settings={"do": "hang", "seconds": 1})
    write = runner._write

    def too_late(session, done, files):
        claim(session, job_id, "another")
        return write(session, done, files)

    runner._write = too_late
    run(runner, job_id)
    assert results(database) == []
    assert [name for name, _ in store.names()] == [visit.recordings[0].sha256]


def test_a_shutdown_lets_the_job_wait_and_costs_no_attempt(runner, visit, database):
    job_id = submit_job(database, visit, settings={"do": "hang"})
    with pytest.raises(TryAgain):
        asyncio.run(during(runner, job_id, lambda: setattr(runner, "stopping", True)))
    job = job_of(database, job_id)
    assert (job.status, job.losses) == (JobStatus.QUEUED, 0)


def test_deleting_the_patient_ends_the_computation_without_a_trace(runner, visit, database, store):
    job_id = submit_job(database, visit, settings={"do": "hang"})
    asyncio.run(during(runner, job_id, lambda: delete_patient(database, store, visit.patient_id, SYSTEM)))
    with database.sessions() as session:
        left = [session.scalar(select(func.count()).select_from(table)) for table in (Job, Result, StoredFile)]
    assert left == [0, 0, 0]
    assert list(store.names()) == []


def test_an_inspection_reaches_the_recording(runner, database, store):
    visit = make_visit(database, store, (("broken.c3d", b"no recording"),))
    with database.transaction() as session:
        session.execute(update(Recording).values(inspection={"rows": []}))
    job = run(runner, submit_job(database, visit, JobKind.INSPECT, settings={"do": "describe"}))
    with database.sessions() as session:
        recording = session.scalars(select(Recording)).one()
    assert job.status is JobStatus.SUCCEEDED
    assert recording.inspection == {"rows": [["frames", "3"]]}
    assert (recording.personal_entries, recording.version) == (["a name"], 2)


@pytest.mark.parametrize(("changed", "gained"), [(False, True), (True, False)])
def test_a_body_gains_the_model_unless_its_measurements_changed(runner, visit, database, changed, gained):
    with database.transaction() as session:
        subject = Subject(session_id=visit.session_id, parameters={"mass": 31 if changed else 30})
        session.add(subject)
        session.flush()
        body = subject.id
    run(runner, submit_job(database, visit, settings={"do": "model", "parameters": {"mass": 30.0}, OWNER: str(body)}))
    with database.sessions() as session:
        assert (session.get(Subject, body).model_sha256 is not None) is gained


def test_a_killed_process_is_a_crash_that_is_tried_again(runner, visit, database):
    job_id = submit_job(database, visit, settings={"do": "hang"})
    others = psutil.Process().children()

    def kill():
        (child,) = [each for each in psutil.Process().children() if each not in others]
        child.kill()

    with pytest.raises(TryAgain):
        asyncio.run(during(runner, job_id, kill))
    assert job_of(database, job_id).failure["signal"] == "SIGKILL"
