"""A result of the command line in the database."""

import pytest
from job_requests import request_of
from sqlalchemy import select
from stored import make_visit
from synthetic_output import document, walk_arrays, write_output

from gaitlab.errors import OutputError
from gaitlab.jobs.imported import import_result
from gaitlab.storage.models import Job, JobStatus, ResultFile


@pytest.fixture
def visit(database, store):
    return make_visit(database, store)


def test_it_stands_there_as_if_a_job_had_made_it(database, store, visit, tmp_path):
    folder = write_output(tmp_path / "out", document("walk"), walk_arrays())
    with database.transaction() as session:
        result_id = import_result(session, store, request_of(visit), folder).id
    with database.sessions() as session:
        (job,) = session.scalars(select(Job))
        files = {file.name: file for file in session.scalars(select(ResultFile))}
    assert (job.status, job.session_id) == (JobStatus.SUCCEEDED, visit.session_id)
    assert {file.result_id for file in files.values()} == {result_id}
    assert store.read(files["walk.npz"].sha256) == (folder / "walk.npz").read_bytes()


@pytest.mark.parametrize(("status", "converged"), [("solved", True), ("not_converged", False)])
def test_it_says_whether_the_weights_were_found(database, store, visit, tmp_path, status, converged):
    folder = write_output(tmp_path / "out", document("walk", status))
    with database.transaction() as session:
        result = import_result(session, store, request_of(visit), folder)
        assert result.converged is converged
        assert result.summary["trials"] == ["walk"]
        assert result.summary["weights"]["stability"] == 0.55


def test_a_folder_without_a_result_is_refused(database, store, visit, tmp_path):
    with pytest.raises(OutputError, match=r"holds no result\.json"), database.transaction() as session:
        import_result(session, store, request_of(visit), tmp_path)
