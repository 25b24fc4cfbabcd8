"""A backup brings a new installation to the state of the old one."""

import tarfile

import pytest
from sqlalchemy import select, text
from stored import make_visit

from gaitlab.errors import StorageError
from gaitlab.jobs.queue import enqueue
from gaitlab.storage.backup import back_up, restore
from gaitlab.storage.encryption import FileKey
from gaitlab.storage.files import FileStore
from gaitlab.storage.models import AuditEntry, Job, JobKind, Recording
from gaitlab.storage.objects import DiskObjects


def state(database):
    """All rows of all tables as text."""
    with database.engine.connect() as connection:
        query = "SELECT table_name FROM information_schema.tables WHERE table_schema = 'public' ORDER BY 1"
        names = list(connection.scalars(text(query)))
        return {name: sorted(map(str, connection.execute(text(f'SELECT * FROM "{name}"')))) for name in names}


@pytest.fixture
def filled(database, store):
    make_visit(database, store)
    with database.transaction() as session:
        session.add(AuditEntry(action="read", kind="patients"))
        job = Job(kind=JobKind.INSPECT, input_hash="0" * 64, settings={"text": "tab\t, newline\n, backslash \\"})
        session.add(job)
        session.flush()
        enqueue(session, job)
    return database


def test_everything_comes_back_even_into_an_encrypted_store(filled, store, empty_database, tmp_path):
    back_up(filled, store, tmp_path / "backup.tar")
    objects = DiskObjects(tmp_path / "new")
    encrypted = FileStore(objects, objects.spool, FileKey(bytes(32)))
    manifest = restore(empty_database, encrypted, tmp_path / "backup.tar")
    assert manifest.files == 1
    assert state(empty_database) == state(filled)
    with empty_database.sessions() as session:
        assert encrypted.read(session.scalars(select(Recording.sha256)).one()) == b"walk"


def test_new_rows_get_new_numbers_after_a_restore(filled, store, empty_database, tmp_path):
    back_up(filled, store, tmp_path / "backup.tar")
    restore(empty_database, store, tmp_path / "backup.tar")
    with empty_database.transaction() as session:
        session.add(AuditEntry(action="read", kind="patients"))
        job = session.scalars(select(Job)).one()
        before = job.queue_job_id
        enqueue(session, job)
        assert job.queue_job_id > before


def test_a_database_with_tables_is_left_alone(filled, store, tmp_path):
    back_up(filled, store, tmp_path / "backup.tar")
    before = state(filled)
    with pytest.raises(StorageError, match="not empty"):
        restore(filled, store, tmp_path / "backup.tar")
    assert state(filled) == before


def test_a_damaged_file_is_noticed(filled, store, empty_database, tmp_path):
    path = tmp_path / "backup.tar"
    back_up(filled, store, path)
    with tarfile.open(path) as archive:
        entry = next(member for member in archive if member.name.startswith("files/"))
    content = bytearray(path.read_bytes())
    content[entry.offset_data] ^= 1
    path.write_bytes(content)
    with pytest.raises(StorageError, match="damaged"):
        restore(empty_database, store, path)


@pytest.mark.parametrize("content", [b"", b"no tar file" * 100])
def test_something_else_is_no_backup(empty_database, store, tmp_path, content):
    (tmp_path / "other").write_bytes(content)
    with pytest.raises(StorageError, match="cannot be read as a backup"):
        restore(empty_database, store, tmp_path / "other")


def test_others_cannot_read_a_backup(filled, store, tmp_path):
    back_up(filled, store, tmp_path / "backup.tar")
    assert (tmp_path / "backup.tar").stat().st_mode & 0o077 == 0
    assert [path.name for path in tmp_path.glob("*.part")] == []
