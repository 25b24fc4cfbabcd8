"""Backup and restore of a whole installation, independent of the version of PostgreSQL and of where the files lie.

A backup is one tar file: `manifest.json`, then `tables/<name>` as PostgreSQL's COPY writes them, all of one moment,
then `files/<sha256>`. Tables are in clear; files, too: keep a backup as you keep the data, or encrypt it as a whole.
"""

import io
import os
import tarfile
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any

import msgspec
from sqlalchemy import Connection, MetaData, Table, select, text

from .. import __version__
from ..errors import StorageError
from .database import Database
from .files import FileStore
from .migrate import migrate, newest_revision, present_revision
from .models import StoredFile
from .schema import now

FORMAT = 1
REVISIONS = "alembic_version"


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """What a backup holds."""

    format: int
    gaitlab: str
    revision: str
    made_at: str
    tables: dict[str, tuple[str, ...]]
    """Columns of each table, in their order in the file."""
    files: int


def back_up(database: Database, store: FileStore | None, path: Path) -> Manifest:
    """Write a backup to `path`, which appears only when it is complete. `store`: None leaves the files away.

    The service may run meanwhile: tables are of one moment, and files of that moment are not removed before they are
    copied, unless somebody deletes a patient; such a file is left out.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as raw:
            os.fchmod(raw.fileno(), 0o600)
            with tarfile.open(fileobj=raw, mode="w") as archive:
                manifest = _write(database, store, archive)
            raw.flush()
            os.fsync(raw.fileno())
        part.replace(path)
    except OSError as error:
        raise StorageError(f"{path} cannot be written ({error.strerror})") from error
    finally:
        part.unlink(missing_ok=True)
    return manifest


def restore(database: Database, store: FileStore, path: Path) -> Manifest:
    """Bring an empty database and a store to the state of a backup.

    Raises:
        StorageError: The file is no backup, is damaged or of a newer gaitlab, or the database is not empty.
    """
    try:
        with tarfile.open(path) as archive:
            manifest = _manifest(archive)
            _check(database, manifest)
            migrate(database, manifest.revision)
            with database.engine.connect() as connection, connection.begin():
                _read_tables(connection, archive, manifest)
            for entry in archive:
                if entry.name.startswith("files/"):
                    _read_file(store, archive, entry)
    except (OSError, tarfile.TarError, msgspec.MsgspecError) as error:
        raise StorageError(f"{path} cannot be read as a backup ({error})") from error
    migrate(database)
    return manifest


def _write(database: Database, store: FileStore | None, archive: tarfile.TarFile) -> Manifest:
    with database.engine.connect().execution_options(isolation_level="REPEATABLE READ") as connection:
        tables = _tables(connection)
        digests = connection.scalars(select(StoredFile.sha256)).all() if store is not None else []
        manifest = Manifest(
            format=FORMAT,
            gaitlab=__version__,
            revision=present_revision(database),
            made_at=now().isoformat(),
            tables={str(table.name): tuple(str(column.name) for column in table.c) for table in tables},
            files=len(digests),
        )
        _add(archive, "manifest.json", io.BytesIO(msgspec.json.encode(manifest)))
        for name, columns in manifest.tables.items():
            with tempfile.TemporaryFile() as file:
                with _cursor(connection).copy(f'COPY "{name}" ({_quoted(columns)}) TO STDOUT') as copy:
                    for block in copy:
                        file.write(block)
                _add(archive, f"tables/{name}", file)
    if store is not None:
        _write_files(store, archive, digests)
    return manifest


def _write_files(store: FileStore, archive: tarfile.TarFile, digests: Sequence[str]) -> None:
    for digest in digests:
        if store.exists(digest):
            with tempfile.TemporaryFile() as file:
                for piece in store.open(digest):
                    file.write(piece)
                _add(archive, f"files/{digest}", file)


def _add(archive: tarfile.TarFile, name: str, file: IO[bytes]) -> None:
    entry = tarfile.TarInfo(name)
    entry.size = file.seek(0, os.SEEK_END)
    entry.mtime = int(now().timestamp())
    entry.mode = 0o600
    file.seek(0)
    archive.addfile(entry, file)


def _manifest(archive: tarfile.TarFile) -> Manifest:
    file = archive.extractfile("manifest.json")
    manifest = msgspec.json.decode(b"" if file is None else file.read(), type=Manifest)
    if manifest.format > FORMAT:
        raise StorageError(
            f"the backup is of gaitlab {manifest.gaitlab}, this is {__version__}: install that or a newer one"
        )
    return manifest


def _check(database: Database, manifest: Manifest) -> None:
    if present_revision(database):
        raise StorageError("the database is not empty: restore into a new data folder or a new database")
    if manifest.revision > newest_revision():
        raise StorageError(
            f"the backup has the form {manifest.revision}, newer than {newest_revision()}: update gaitlab"
        )


def _read_tables(connection: Connection, archive: tarfile.TarFile, manifest: Manifest) -> None:
    # In the order of references, not of the tar file.
    for table in [table for table in _tables(connection) if table.name in manifest.tables and table.name != REVISIONS]:
        columns = manifest.tables[table.name]
        file = archive.extractfile(f"tables/{table.name}")
        if file is None:
            raise StorageError(f"the backup lacks the table {table.name}")
        connection.execute(text(f'ALTER TABLE "{table.name}" DISABLE TRIGGER USER'))
        with _cursor(connection).copy(f'COPY "{table.name}" ({_quoted(columns)}) FROM STDIN') as copy:
            while block := file.read(1 << 20):
                copy.write(block)
        connection.execute(text(f'ALTER TABLE "{table.name}" ENABLE TRIGGER USER'))
        _advance(connection, table)


def _advance(connection: Connection, table: Table) -> None:
    """Let the numbers of new rows begin after those restored."""
    if "id" not in table.c:
        return
    sequence = connection.scalar(text("SELECT pg_get_serial_sequence(:table, 'id')"), {"table": table.name})
    if sequence is not None:
        last = connection.scalar(text(f'SELECT coalesce(max(id), 0) + 1 FROM "{table.name}"'))
        connection.execute(text("SELECT setval(:sequence, :last, false)"), {"sequence": sequence, "last": last})


def _read_file(store: FileStore, archive: tarfile.TarFile, entry: tarfile.TarInfo) -> None:
    file = archive.extractfile(entry)
    digest = entry.name.removeprefix("files/")
    if file is None or store.put(_pieces(file)).sha256 != digest:
        raise StorageError(f"the backup's file {digest[:12]} is damaged")


def _pieces(file: IO[bytes]) -> Iterator[bytes]:
    while piece := file.read(1 << 20):
        yield piece


def _tables(connection: Connection) -> list[Table]:
    """All tables, those first that others refer to."""
    found = MetaData()
    found.reflect(connection)
    return found.sorted_tables


def _quoted(columns: Sequence[str]) -> str:
    return ", ".join(f'"{name}"' for name in columns)


def _cursor(connection: Connection) -> Any:
    driver: Any = connection.connection.driver_connection
    return driver.cursor()
