"""All tables, and the job queue of procrastinate."""

from importlib.metadata import version
from pathlib import Path
from typing import Any

from alembic import op
from procrastinate.schema import SchemaManager

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Make the tables, and the queue's in the form of the installed procrastinate, which is noted at its table.

    A later step that brings a newer queue must look at that note: new databases have the newer form already.
    """
    # The driver's own method: SQLAlchemy's would read every % as a parameter.
    run: Any = op.get_bind().connection.driver_connection
    run.execute(Path(__file__).with_suffix(".sql").read_text(encoding="utf-8"))
    run.execute(SchemaManager.get_schema())
    run.execute(f"COMMENT ON TABLE procrastinate_jobs IS 'procrastinate {version('procrastinate')}'")
