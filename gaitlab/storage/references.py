"""Which rows use which stored content, and the removal of contents that no row uses.

A content may be removed and arrive anew at the same time. An advisory lock per content puts these in an order: whoever
refers to a content holds it shared until the end of the transaction and looks whether the content is there; whoever
removes it holds it alone.
"""

import time
from collections.abc import Iterable

from sqlalchemy import ColumnElement, delete, exists, or_, select, text
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.orm import Session

from ..errors import StorageError
from .database import Database
from .files import FileStore, Stored
from .models import Attachment, Recording, ReportVersion, ResultFile, StoredFile, Subject, UploadChunk

GRACE = 24 * 3600.0
"""Age before which an unknown content counts as one that is just arriving [s]."""


def refer(session: Session, store: FileStore, stored: Stored) -> None:
    """Make the row of a content that was put into the store, so that other rows of this transaction can refer to it.

    Raises:
        StorageError: The content was removed since `put`; put it again.
    """
    session.execute(text("SELECT pg_advisory_xact_lock_shared(:key)"), {"key": _key(stored.sha256)})
    if not store.exists(stored.sha256):
        raise StorageError("the file was removed while it was being registered: send it again")
    session.execute(insert(StoredFile).values(sha256=stored.sha256, size=stored.size).on_conflict_do_nothing())


def remove_unused(database: Database, store: FileStore, digests: Iterable[str]) -> int:
    """Remove those of the contents that no row refers to; returns how many."""
    removed = 0
    for digest in sorted(set(digests)):
        with database.transaction() as session:
            session.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _key(digest)})
            if session.scalar(select(_used(digest))):
                continue
            # The content first: a row without content is harmless, a content without row would stay for ever.
            store.delete(digest)
            session.execute(delete(StoredFile).where(StoredFile.sha256 == digest))
            removed += 1
    return removed


def collect_garbage(database: Database, store: FileStore, grace: float = GRACE) -> int:
    """Remove contents that no row refers to and that are older than `grace` [s]; returns how many."""
    with database.sessions() as session:
        known = set(session.scalars(select(StoredFile.sha256)))
    removed = remove_unused(database, store, _old(database, known, grace))
    names = {store.object_name(digest) for digest in known}
    for name, written in list(store.names()):
        if name not in names and written < time.time() - grace:
            store.delete_object(name)
            removed += 1
    store.clear_spool(time.time() - grace)
    return removed


def _old(database: Database, digests: set[str], grace: float) -> list[str]:
    statement = select(StoredFile.sha256).where(
        StoredFile.created_at < text("now() - make_interval(secs => :grace)").bindparams(grace=grace)
    )
    with database.sessions() as session:
        return [digest for digest in session.scalars(statement) if digest in digests]


def _used(digest: str) -> ColumnElement[bool]:
    columns = (
        Attachment.sha256,
        Recording.sha256,
        Subject.model_sha256,
        UploadChunk.sha256,
        ResultFile.sha256,
        ReportVersion.html_sha256,
        ReportVersion.pdf_sha256,
    )
    return or_(*(exists().where(column == digest) for column in columns))


def _key(digest: str) -> int:
    return int.from_bytes(bytes.fromhex(digest)[:8], "big", signed=True)
