"""`gaitlab doctor`: what is wrong with an installation, and what to do."""

import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from rich.console import Console
from rich.table import Table
from sqlalchemy import func, select

from ..errors import GaitlabError, OutputError, StorageError
from ..jobs.metrics import alive_workers
from ..storage.database import Database
from ..storage.files import FileStore, open_store
from ..storage.migrate import newest_revision, present_revision
from ..storage.models import Job, JobStatus, StoredFile
from ..storage.settings import Settings
from .given_settings import settings_of
from .service import running_database

LEAST_DISK = 5e9  # [bytes]
SAMPLE = b"gaitlab doctor"


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One line of the table."""

    subject: str
    text: str
    well: bool = True


def doctor(given: Mapping[str, Any], verify: bool) -> None:
    """Print all findings; raises OutputError if one of them is bad."""
    settings = settings_of(given)
    findings = list(examine(settings, verify))
    table = Table("", "what", "finding", title=f"gaitlab in {settings.data_dir}")
    for each in findings:
        table.add_row("ok" if each.well else "BAD", each.subject, each.text)
    Console().print(table)
    bad = [each.subject for each in findings if not each.well]
    if bad:
        raise OutputError(f"not in order: {', '.join(bad)}")


def examine(settings: Settings, verify: bool) -> Iterator[Finding]:
    """Look at everything; what cannot be looked at is a finding, too."""
    yield from _machine(settings)
    try:
        with running_database(settings) as (url, _):
            database = Database.open(url)
            try:
                store = open_store(settings)
                checks = [_version, _tables, _jobs, _workers]
                yield from (_try(check, database) for check in checks)
                yield _try(_files, store)
                if verify:
                    yield _try(partial(_verify, store), database)
            finally:
                database.close()
    except GaitlabError as error:
        yield Finding(subject="start", text=str(error), well=False)


def _try(check: Callable[[Any], Finding], subject: Any) -> Finding:
    try:
        return check(subject)
    except (GaitlabError, OSError) as error:
        return Finding(subject="access", text=str(error), well=False)


def _machine(settings: Settings) -> Iterator[Finding]:
    settings.data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
    free = shutil.disk_usage(settings.data_dir).free
    yield Finding(subject="disk", text=f"{free / 1e9:.0f} GB free", well=free > LEAST_DISK)
    mode = settings.data_dir.stat().st_mode & 0o066
    yield Finding(
        subject="data folder",
        text="closed to others" if not mode else f"others may read it: chmod 700 {settings.data_dir}",
        well=not mode,
    )
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    together = settings.job_memory * settings.concurrency
    advice = "" if together <= 2 * memory else ": analyses may use more; set GAITLAB_JOB_MEMORY or a lower concurrency"
    yield Finding(subject="memory", text=f"{memory / 1e9:.0f} GB{advice}", well=not advice)
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    yield Finding(subject="compiler", text=compiler or "none: derivatives are interpreted, analyses take longer")
    exposed = settings.host not in ("127.0.0.1", "::1", "localhost") and not settings.secure_cookies
    yield Finding(
        subject="network",
        text="open to others without TLS: give --tls-certificate and --tls-key, or a proxy and --public-url https://..."
        if exposed
        else f"listens on {settings.host}",
        well=not exposed,
    )


def _version(database: Database) -> Finding:
    return Finding(subject="database", text=f"PostgreSQL {database.check()}")


def _tables(database: Database) -> Finding:
    present, newest = present_revision(database), newest_revision()
    if present == newest:
        return Finding(subject="tables", text=f"form {present}")
    return Finding(subject="tables", text=f"form {present or 'none'}, {newest} at the next start of gaitlab serve")


def _jobs(database: Database) -> Finding:
    if not present_revision(database):
        return Finding(subject="jobs", text="none yet")
    with database.sessions() as session:
        counts = dict(session.execute(select(Job.status, func.count()).group_by(Job.status)).all())
    words = ", ".join(f"{counts.get(status, 0)} {status.value}" for status in JobStatus)
    return Finding(subject="jobs", text=words)


def _workers(database: Database) -> Finding:
    if not present_revision(database):
        return Finding(subject="workers", text="none yet")
    with database.sessions() as session:
        alive = alive_workers(session)
        waiting = session.scalar(select(func.count()).where(Job.status == JobStatus.QUEUED)) or 0
    return Finding(
        subject="workers",
        text=f"{alive} alive" if alive or not waiting else f"none, and {waiting} jobs wait: start gaitlab worker",
        well=bool(alive or not waiting),
    )


def _files(store: FileStore) -> Finding:
    stored = store.put([SAMPLE])
    try:
        if store.read(stored.sha256) != SAMPLE:
            raise StorageError("the file store returns something else than was stored")
    finally:
        store.delete(stored.sha256)
    return Finding(subject="files", text="written, read and removed again")


def _verify(store: FileStore, database: Database) -> Finding:
    with database.sessions() as session:
        digests = list(session.scalars(select(StoredFile.sha256)))
    damaged = [digest[:12] for digest in digests if not _intact(store, digest)]
    text_ = f"{len(digests)} files, {len(damaged)} damaged or missing {' '.join(damaged)}".strip()
    return Finding(subject="contents", text=text_, well=not damaged)


def _intact(store: FileStore, digest: str) -> bool:
    try:
        for _ in store.open(digest):
            pass
    except StorageError:
        return False
    return True
