"""Addresses of databases, and what may be said about their errors."""

from contextlib import ExitStack

import pytest
from sqlalchemy import text
from sqlalchemy.exc import IntegrityError
from stored import execute

from gaitlab.errors import StorageError
from gaitlab.storage.database import NEWEST, OLDEST, Database
from gaitlab.storage.models import Patient
from gaitlab.storage.settings import Settings

BACKEND = text("SELECT pg_backend_pid()")


@pytest.mark.parametrize(("url", "problem"), [("nonsense", "of the form"), ("sqlite:///x", "only postgresql")])
def test_other_addresses_are_refused(url, problem):
    with pytest.raises(StorageError, match=problem):
        Database.open(url)


def test_a_server_that_is_away_is_one_sentence(tmp_path):
    with pytest.raises(StorageError, match="no connection to the database"):
        Database.open(f"postgresql://x:y@/z?host={tmp_path}").check()


def test_the_version_is_one_of_those_supported(database):
    assert OLDEST <= database.check() <= NEWEST


def test_passwords_show_in_no_representation(database, tmp_path):
    settings = Settings(data_dir=tmp_path, database_url="postgresql://x:hunter2@/z")
    assert "hunter2" not in repr(settings)
    assert database.url not in repr(database)
    assert settings.plain()["database_url"] == "postgresql://x:hunter2@/z"


def test_refused_statements_do_not_repeat_their_values(database):
    for _ in range(2):
        try:
            with database.transaction() as session:
                session.add(Patient(pseudonym="P001", notes="Jane Doe"))
        except IntegrityError as error:
            refused = str(error)
    assert "Jane Doe" not in refused


def test_connections_that_the_server_has_closed_are_replaced(database):
    """As after a restart of the server, nobody sees an error: each idle connection is looked at before its use."""
    with ExitStack() as stack:
        numbers = [stack.enter_context(database.transaction()).scalar(BACKEND) for _ in range(3)]
    execute(f"SELECT pg_terminate_backend(number, 5000) FROM unnest(ARRAY{numbers}) AS number")
    for _ in range(3):
        with database.transaction() as session:
            assert session.scalar(BACKEND) not in numbers


def test_a_connection_is_used_again(database):
    numbers = set()
    for _ in range(3):
        with database.transaction() as session:
            numbers.add(session.scalar(BACKEND))
    assert len(numbers) == 1
