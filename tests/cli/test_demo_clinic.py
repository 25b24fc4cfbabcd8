"""`gaitlab demo-clinic`: the web application with the demo patients in it."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import httpx
import psutil
import pytest
from sqlalchemy import func, select
from stored import database, open_folder, store
from synthetic_output import document, walk_arrays, write_output

from gaitlab.cli.demo_patients import LOGINS, PASSWORD, add_demo_patients
from gaitlab.errors import OutputError
from gaitlab.storage.models import Job, JobKind, JobStatus, Patient, Recording, Result, User

__all__ = ["database", "store"]
CHILD = "demo_cp_child"


@pytest.fixture
def results(tmp_path):
    return write_output(tmp_path / "demo", document("walk1"), walk_arrays())


def test_both_children_are_there_and_one_has_its_result(database, store, results):
    assert add_demo_patients(database, store, CHILD, results)
    with database.sessions() as session:
        names = dict(session.execute(select(Patient.pseudonym, Patient.id)).all())
        (result,) = session.scalars(select(Result))
        jobs = {(job.kind, job.status) for job in session.scalars(select(Job))}
        assert session.scalar(select(func.count()).select_from(Recording)) == 6
    assert set(names) == {"DEMO-CP", "DEMO-ABLE-BODIED"}
    assert result.summary["trials"] == ["walk1"]
    assert (JobKind.ANALYSE, JobStatus.QUEUED) in jobs and (JobKind.INSPECT, JobStatus.QUEUED) in jobs


def test_a_database_with_accounts_is_left_as_it_is(database, store, results):
    add_demo_patients(database, store, CHILD, results)
    assert not add_demo_patients(database, store, CHILD, results)
    with database.sessions() as session:
        assert session.scalar(select(func.count()).select_from(User)) == len(LOGINS)


def test_without_a_result_nothing_is_kept(database, store, tmp_path):
    with pytest.raises(OutputError, match=r"holds no result\.json"):
        add_demo_patients(database, store, CHILD, tmp_path)
    with database.sessions() as session:
        assert session.scalar(select(func.count()).select_from(User)) == 0


@pytest.mark.slow
def test_without_a_terminal_it_answers_in_the_background_and_is_found_again(results):
    folder = open_folder()
    command = [sys.executable, "-c", "from gaitlab.cli import main; main()", "demo-clinic"]
    command += ["--results", str(results), "--data-dir", str(folder / "data")]
    told = subprocess.run(command, capture_output=True, text=True, timeout=240, check=True).stdout
    address, process = re.search(r"gaitlab: (\S+)", told)[1], int(re.search(r"kill (\d+)", told)[1])
    try:
        with httpx.Client(base_url=address) as client:
            signed_in = client.post("/api/v1/auth/sign-in", json={"login": "demo", "password": PASSWORD})
            patients = client.get("/api/v1/patients").json()["items"]
        again = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
    finally:
        os.kill(process, signal.SIGTERM)
        gone = ended(process)
    assert (signed_in.status_code, len(patients)) == (200, 2)
    assert again == f"the demo runs already: {address}\n"
    assert gone
    shutil.rmtree(folder)


def ended(process, seconds=60.0):
    """Wait for the end of a process that is not our child."""
    deadline = time.monotonic() + seconds
    with contextlib.suppress(psutil.NoSuchProcess):
        while time.monotonic() < deadline and psutil.Process(process).status() != psutil.STATUS_ZOMBIE:
            time.sleep(0.2)
        return psutil.Process(process).status() == psutil.STATUS_ZOMBIE
    return True
