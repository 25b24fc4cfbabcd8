"""Bringing the tables of a database to the form that this version of gaitlab needs."""

from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import text

from ..errors import StorageError
from .database import Database

LOCK = 7_024_611
"""Number of the advisory lock that lets one process migrate at a time."""


def _config() -> Config:
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations").replace("%", "%%"))
    return config


def newest_revision() -> str:
    """The form of tables that this version needs."""
    return ScriptDirectory.from_config(_config()).get_current_head() or ""


def present_revision(database: Database) -> str:
    """The form of tables in the database; empty for an empty database."""
    with database.engine.connect() as connection:
        return MigrationContext.configure(connection).get_current_revision() or ""


def migrate(database: Database, revision: str = "head") -> bool:
    """Run the missing steps in one transaction; returns whether there were any.

    Args:
        database: The database; several processes may call this at the same time.
        revision: The form to stop at.

    Raises:
        StorageError: The database was made by a newer gaitlab.
    """
    config = _config()
    known = {script.revision for script in ScriptDirectory.from_config(config).walk_revisions()}
    with database.engine.connect() as connection, connection.begin():
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": LOCK})
        present = MigrationContext.configure(connection).get_current_revision() or ""
        if present == newest_revision():
            return False
        if present and present not in known:
            raise StorageError(
                f"the database has the form {present}, which this gaitlab does not know (its newest is "
                f"{newest_revision()}): install the gaitlab that made it, or a newer one"
            )
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
    return True
