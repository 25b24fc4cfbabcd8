"""Addresses of databases, and what may be said about their errors."""

import pytest
from sqlalchemy.exc import IntegrityError

from gaitlab.errors import StorageError
from gaitlab.storage.database import NEWEST, OLDEST, Database
from gaitlab.storage.models import Patient
from gaitlab.storage.settings import Settings


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
