"""The tables of a database and those of the models agree; forms are recognised."""

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import text
from sqlalchemy.exc import DBAPIError

from gaitlab.errors import StorageError
from gaitlab.storage.migrate import migrate, newest_revision, present_revision
from gaitlab.storage.models import AuditEntry, Row


def is_ours(thing, name, kind, reflected, compare_to):
    del thing, reflected, compare_to  # Unused.
    return kind != "table" or not name.startswith("procrastinate_")


def test_an_empty_database_gets_the_newest_form_once(empty_database):
    assert present_revision(empty_database) == ""
    assert migrate(empty_database)
    assert present_revision(empty_database) == newest_revision()
    assert not migrate(empty_database)


def test_tables_are_those_of_the_models(database):
    with database.engine.connect() as connection:
        options = {"compare_type": True, "compare_server_default": False, "include_object": is_ours}
        context = MigrationContext.configure(connection, opts=options)
        assert compare_metadata(context, Row.metadata) == []


def test_nothing_is_deleted_by_cascade(database):
    with database.engine.connect() as connection:
        query = "SELECT conrelid::regclass::text FROM pg_constraint WHERE contype = 'f' AND confdeltype = 'c'"
        cascading = set(connection.scalars(text(query)))
    assert {name for name in cascading if not name.startswith("procrastinate_")} == set()


def test_a_database_of_a_newer_gaitlab_is_refused(database):
    with database.transaction() as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(StorageError, match="9999"):
        migrate(database)


def test_the_audit_log_cannot_be_changed(database):
    with database.transaction() as session:
        session.add(AuditEntry(action="read", kind="patients"))
    for statement in ("UPDATE audit_log SET action = 'nothing'", "DELETE FROM audit_log"):
        with pytest.raises(DBAPIError, match="cannot be changed"), database.transaction() as session:
            session.execute(text(statement))
