"""What the commands of the server do."""

import contextlib
import signal
import socket
import threading
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from types import FrameType
from typing import Any

import structlog
import typer
from pydantic import SecretStr, ValidationError
from sqlalchemy import delete, exists, select

from ..api.tokens import LINK, new_token
from ..errors import OutputError, StorageError
from ..jobs.logs import configure_logs
from ..storage.backup import back_up, restore
from ..storage.database import Database
from ..storage.embedded import EmbeddedPostgres, make_private, write_private
from ..storage.encryption import FileKey
from ..storage.files import open_store
from ..storage.migrate import migrate, newest_revision, present_revision
from ..storage.models import OneTimePurpose, OneTimeToken, User
from ..storage.schema import now
from ..storage.settings import Settings
from .children import Child, end_all
from .worker_process import run_worker

WATCH_SECONDS = 0.5
"""Time between two looks at the processes."""
LINK_HOURS = 24.0
BACKLOG = 512
log = structlog.stdlib.get_logger()


def settings_of(given: Mapping[str, Any]) -> Settings:
    """Settings from the environment, and from the command line where something is given there."""
    try:
        return Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        problems = [f"{'.'.join(map(str, each['loc']))}: {each['msg']}" for each in error.errors()]
        raise OutputError(f"the settings cannot be used: {'; '.join(problems)}") from error


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


def serve(given: Mapping[str, Any]) -> None:
    """`gaitlab serve`."""
    settings = settings_of(given)
    configure_logs(settings.log_format)
    stop = _stop_on_signals()
    with _listening(settings) as listener:
        children = [Child("gaitlab.cli.web_process", [listener.fileno()])]
        if settings.worker:
            children.append(Child("gaitlab.cli.worker_process"))
        try:
            # They load their modules while the database starts.
            _watch(children, None)
            with running_database(settings) as (url, server):
                prepare(settings, url)
                settings = settings.model_copy(update={"database_url": SecretStr(url)})
                for child in children:
                    child.tell(settings.plain())
                _tell(settings, url, listener.getsockname()[1])
                try:
                    while not stop.is_set():
                        _watch(children, server)
                        stop.wait(WATCH_SECONDS)
                finally:
                    # Before the database goes.
                    end_all(children)
        finally:
            end_all(children)


def _watch(children: list[Child], server: EmbeddedPostgres | None) -> None:
    try:
        if server is not None and server.ensure_running():
            log.warning("the embedded database had died and runs again")
    except StorageError as error:
        log.error("the embedded database does not start", reason=str(error))
    for child in children:
        child.ensure_running()


def _stop_on_signals() -> threading.Event:
    stop = threading.Event()

    def handle(number: int, frame: FrameType | None) -> None:
        del number, frame  # Unused.
        stop.set()

    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, handle)
    return stop


@contextmanager
def _listening(settings: Settings) -> Generator[socket.socket]:
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((settings.host, settings.port))
        except OSError as error:
            raise OutputError(f"{settings.host}:{settings.port} cannot be listened on ({error.strerror})") from error
        listener.listen(BACKLOG)
        yield listener


def _tell(settings: Settings, url: str, port: int) -> None:
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


def work(given: Mapping[str, Any]) -> None:
    """`gaitlab worker`."""
    settings = settings_of(given)
    configure_logs(settings.log_format)
    with running_database(settings) as (url, _):
        prepare(settings, url)
        run_worker(settings, url)


def back_up_to(given: Mapping[str, Any], target: Path) -> None:
    """`gaitlab backup`."""
    settings = settings_of(given)
    with running_database(settings) as (url, _), _opened(url) as database:
        manifest = back_up(database, open_store(settings), target)
    typer.echo(f"{target}: {len(manifest.tables)} tables, {manifest.files} files, form {manifest.revision}")


def restore_from(given: Mapping[str, Any], source: Path) -> None:
    """`gaitlab restore`."""
    settings = settings_of(given)
    with running_database(settings) as (url, _), _opened(url) as database:
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
def _opened(url: str) -> Generator[Database]:
    with contextlib.closing(Database.open(url)) as database:
        database.check()
        yield database
