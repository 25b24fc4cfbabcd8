"""One PostgreSQL for all tests, and a fresh database for each: embedded, or that of GAITLAB_TEST_DATABASE_URL."""

import atexit
import functools
import os
import shutil
import tempfile
import uuid
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import psycopg
import pytest
from sqlalchemy import make_url

from gaitlab.storage.database import Database
from gaitlab.storage.embedded import EmbeddedPostgres
from gaitlab.storage.files import FileStore
from gaitlab.storage.migrate import migrate
from gaitlab.storage.models import GaitSession, Patient, Recording, RecordingKind
from gaitlab.storage.objects import DiskObjects
from gaitlab.storage.references import refer

EXTERNAL = "GAITLAB_TEST_DATABASE_URL"


def open_folder() -> Path:
    """A folder for a data directory: as root, PostgreSQL runs as another user, who must be able to reach it."""
    folder = Path(tempfile.mkdtemp(prefix="gaitlab-test-"))
    folder.chmod(0o711)
    return folder


@functools.cache
def server_url() -> str:
    """Address of the server; the embedded one stops with the tests."""
    if EXTERNAL in os.environ:
        return os.environ[EXTERNAL]
    folder = open_folder()
    server = EmbeddedPostgres(folder / "data")
    url = server.start()

    def stop() -> None:
        server.stop()
        shutil.rmtree(folder)

    atexit.register(stop)
    return url


def url_of(name: str) -> str:
    """Address of another database of the server."""
    return make_url(server_url()).set(database=name).render_as_string(hide_password=False)


def execute(statement: str) -> None:
    """Run a statement outside of a transaction."""
    with psycopg.connect(server_url(), autocommit=True) as connection:
        connection.execute(statement)


def new_database(template: str | None = None) -> str:
    """Name of a new database."""
    name = f"gaitlab_test_{uuid.uuid4().hex[:12]}"
    execute(f'CREATE DATABASE "{name}"' + (f' TEMPLATE "{template}"' if template else ""))
    return name


@functools.cache
def template() -> str:
    """A migrated database that the others are copied from."""
    name = new_database()
    database = Database.open(url_of(name))
    migrate(database)
    database.close()
    atexit.register(execute, f'DROP DATABASE IF EXISTS "{name}"')
    return name


@pytest.fixture
def empty_database():
    """A database without tables."""
    yield from _database(None)


@pytest.fixture
def database():
    """A migrated database without rows."""
    yield from _database(template())


def _database(of):
    name = new_database(of)
    opened = Database.open(url_of(name))
    yield opened
    opened.close()
    execute(f'DROP DATABASE "{name}" WITH (FORCE)')


@pytest.fixture
def store(tmp_path):
    """A file store."""
    objects = DiskObjects(tmp_path / "files")
    return FileStore(objects, objects.spool)


@dataclass(frozen=True, kw_only=True)
class Visit:
    """A patient with one visit and its recordings."""

    patient_id: uuid.UUID
    session_id: uuid.UUID
    recordings: tuple[Recording, ...]


def make_visit(database, store, contents=(("walk.c3d", b"walk"),), pseudonym="P001"):
    """Make a patient with one visit whose recordings have these names and contents."""
    with database.transaction() as session:
        patient = Patient(pseudonym=pseudonym)
        session.add(patient)
        session.flush()
        visit = GaitSession(patient_id=patient.id, visited_on=date(2026, 11, 22))
        session.add(visit)
        session.flush()
        recordings = []
        for name, content in contents:
            stored = store.put([content])
            refer(session, store, stored)
            kind = RecordingKind.STATIC if "static" in name else RecordingKind.WALK
            recording = Recording(session_id=visit.id, name=name, sha256=stored.sha256, size=stored.size, kind=kind)
            session.add(recording)
            recordings.append(recording)
        session.flush()
        return Visit(patient_id=patient.id, session_id=visit.id, recordings=tuple(recordings))
