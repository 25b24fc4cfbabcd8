"""What the commands of the server do with database and files."""

import contextlib
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from typing import Any

import structlog
import typer
from sqlalchemy import delete, exists, select

from ..api.tokens import LINK, new_token
from ..errors import OutputError
from ..storage.backup import back_up, restore
from ..storage.database import Database
from ..storage.embedded import EmbeddedPostgres, make_private, write_private
from ..storage.encryption import FileKey
from ..storage.files import open_store
from ..storage.migrate import migrate, newest_revision, present_revision
from ..storage.models import OneTimePurpose, OneTimeToken, User
from ..storage.schema import now
from ..storage.settings import Settings
from .given_settings import settings_of

LINK_HOURS = 24.0
log = structlog.stdlib.get_logger()


@contextmanager
def running_database(settings: Settings) -> Generator[tuple[str, EmbeddedPostgres | None]]:
    """Address of the database, and the embedded server if it is that; left, and stopped if unused, at the end."""
    if settings.database_url is not None:
        make_private(settings.data_dir)
        yield settings.database_url.get_secret_value(), None
        return
    server = EmbeddedPostgres(settings.data_dir)
    url = server.start()
    try:
        yield url, server
    finally:
        server.stop()


def prepare(settings: Settings, url: str) -> None:
    """Check the database and bring its tables to the newest form, after a backup of the tables as they were."""
    database = Database.open(url)
    try:
        database.check()
        before = present_revision(database)
        if before and before != newest_revision():
            target = settings.data_dir / "backups" / f"before-migration-{before}-{now():%Y%m%dT%H%M%SZ}.tar"
            back_up(database, None, target)
        if migrate(database):
            log.info("tables brought to a new form", before=before, after=newest_revision())
    finally:
        database.close()


def tell_address(settings: Settings, url: str, port: int) -> None:
    """Print where the service is, and the link to the first account while there is none."""
    scheme = "https" if settings.tls_certificate else "http"
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    base = settings.public_url.rstrip("/") or f"{scheme}://{host}:{port}"
    typer.echo(f"gaitlab: {base}", err=True)
    link = first_account_link(url, base)
    if link:
        typer.echo(f"gaitlab: make the first account, within {LINK_HOURS:g} hours: {link}", err=True)


def first_account_link(url: str, base: str) -> str:
    """A new one-time link while nobody has an account, otherwise nothing."""
    database = Database.open(url)
    try:
        with database.transaction() as session:
            if session.scalar(select(exists(User.id))):
                return ""
            session.execute(delete(OneTimeToken).where(OneTimeToken.purpose == OneTimePurpose.FIRST_ACCOUNT))
            text, hashed = new_token(LINK)
            session.add(
                OneTimeToken(
                    purpose=OneTimePurpose.FIRST_ACCOUNT,
                    token_hash=hashed,
                    expires_at=now() + timedelta(hours=LINK_HOURS),
                )
            )
        # After '#', so that the token is in no server's log.
        return f"{base}/link#{text}"
    finally:
        database.close()


def back_up_to(given: Mapping[str, Any], target: Path) -> None:
    """`gaitlab backup`."""
    settings = settings_of(given)
    with running_database(settings) as (url, _), opened(url) as database:
        manifest = back_up(database, open_store(settings), target)
    typer.echo(f"{target}: {len(manifest.tables)} tables, {manifest.files} files, form {manifest.revision}")


def restore_from(given: Mapping[str, Any], source: Path) -> None:
    """`gaitlab restore`."""
    settings = settings_of(given)
    with running_database(settings) as (url, _), opened(url) as database:
        manifest = restore(database, open_store(settings), source)
    typer.echo(f"restored {len(manifest.tables)} tables and {manifest.files} files of {manifest.made_at}")


def make_key(path: Path) -> None:
    """`gaitlab key`."""
    if path.exists():
        raise OutputError(f"{path} exists: a key is never overwritten")
    try:
        write_private(path, FileKey.make())
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror})") from error
    typer.echo(f"{path}: keep a copy in a safe place; without it encrypted files are lost")


@contextmanager
def opened(url: str) -> Generator[Database]:
    """A database of a supported version, closed at the end."""
    with contextlib.closing(Database.open(url)) as database:
        database.check()
        yield database
