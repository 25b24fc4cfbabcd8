"""Where stored bytes lie: a folder, or an S3-compatible store."""

import os
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any, BinaryIO

import obstore
from obstore.exceptions import BaseError
from obstore.store import ObjectStore, from_url

from ..errors import StorageError

CHUNK = 1 << 20
PROBE = "0" * 64
"""A name that no content has."""
CLIENT = {
    "connect_timeout": timedelta(seconds=5),
    "read_timeout": timedelta(seconds=30),
    # obstore counts the whole body of an answer; its 30 s would cut a large recording on a slow line.
    "timeout": timedelta(hours=2),
}
RETRIES = {"max_retries": 4, "retry_timeout": timedelta(seconds=20)}
"""obstore's own 10 retries in 180 s would let a request wait for minutes while the store is away."""
AT_ONCE = {"max_retries": 0}
PROBE_CLIENT = {"connect_timeout": timedelta(seconds=2), "timeout": timedelta(seconds=3)}


class DiskObjects:
    """Files in a folder, two levels deep. Written, flushed to the disk, renamed, and the folder flushed."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.spool = folder / "spool"
        """Folder in the same file system, for files that are not complete yet."""
        try:
            self.spool.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError as error:
            raise StorageError(f"{folder} cannot be used for files ({error.strerror})") from error

    def write(self, name: str, source: BinaryIO) -> None:
        """Link the spooled file `source` under its name once its bytes are safe."""
        try:
            self._write(name, source)
        except OSError as error:
            raise StorageError(f"the file store cannot be written ({error.strerror})") from error

    def _write(self, name: str, source: BinaryIO) -> None:
        source.flush()
        os.fsync(source.fileno())
        target = self._path(name)
        if not target.parent.is_dir():
            target.parent.mkdir(mode=0o700, exist_ok=True)
            _sync_folder(self._folder)
        # The spooled file keeps its own name until it is closed; a link appears in one step, like a rename.
        part = self.spool / f"{name}.{os.getpid()}.{id(source):x}"
        os.link(source.name, part)
        part.chmod(0o400)
        part.replace(target)
        _sync_folder(target.parent)

    def read(self, name: str) -> Iterator[bytes]:
        """The bytes of a file."""
        try:
            with self._path(name).open("rb") as file:
                while piece := file.read(CHUNK):
                    yield piece
        except OSError as error:
            raise StorageError(f"stored file {name[:12]} cannot be read ({error.strerror})") from error

    def confirm(self, name: str) -> None:
        """Make sure that a file whose name another process has just made survives a loss of power."""
        _sync_folder(self._path(name).parent)

    def exists(self, name: str) -> bool:
        """Whether there is such a file."""
        return self._path(name).is_file()

    def delete(self, name: str) -> None:
        """Remove a file, if it is there."""
        self._path(name).unlink(missing_ok=True)

    def names(self) -> Iterator[tuple[str, float]]:
        """All files with the time of their writing."""
        for path in self._folder.glob("??/*"):
            yield path.parent.name + path.name, path.stat().st_mtime

    def answers(self) -> bool:
        """Whether files can be written now, as far as a look can tell."""
        return os.access(self.spool, os.W_OK)

    def _path(self, name: str) -> Path:
        return self._folder / name[:2] / name[2:]


class RemoteObjects:
    """Objects in an S3-compatible store; credentials come from the AWS_ variables of the environment."""

    def __init__(self, store: ObjectStore, probe: ObjectStore) -> None:
        """`probe`: the same store by a client that gives up quickly."""
        self._store, self._probe = store, probe

    @classmethod
    def open(cls, address: str) -> "RemoteObjects":
        """Store at an address such as s3://bucket/prefix."""
        try:
            return cls(
                from_url(address, client_options=CLIENT | _choices(), retry_config=RETRIES),  # type: ignore[arg-type]
                from_url(address, client_options=PROBE_CLIENT | _choices(), retry_config=AT_ONCE),  # type: ignore[arg-type]
            )
        except (BaseError, ValueError) as error:
            raise StorageError(f"the file store {address} cannot be opened ({error})") from error

    def write(self, name: str, source: BinaryIO) -> None:
        """Upload, in parts when it is large; the store shows an object only when it is complete."""
        try:
            obstore.put(self._store, name, source)
        except (BaseError, OSError) as error:
            raise StorageError(f"the file store does not take a file ({_reason(error)})") from error

    def read(self, name: str) -> Iterator[bytes]:
        """The bytes of an object."""
        try:
            answer: Any = obstore.get(self._store, name)
            for piece in answer.stream(min_chunk_size=CHUNK):
                yield bytes(piece)
        except (BaseError, OSError) as error:
            raise StorageError(f"stored file {name[:12]} cannot be read ({_reason(error)})") from error

    def confirm(self, name: str) -> None:
        """An object that can be seen is safe."""

    def exists(self, name: str) -> bool:
        """Whether there is such an object."""
        try:
            obstore.head(self._store, name)
        except FileNotFoundError:
            return False
        except BaseError as error:
            raise StorageError(f"the file store does not answer ({_reason(error)})") from error
        return True

    def delete(self, name: str) -> None:
        """Remove an object, if it is there."""
        try:
            obstore.delete(self._store, name)
        except FileNotFoundError:
            return
        except BaseError as error:
            raise StorageError(f"the file store does not delete ({_reason(error)})") from error

    def names(self) -> Iterator[tuple[str, float]]:
        """All objects with the time of their writing."""
        for batch in obstore.list(self._store):
            for entry in batch:
                yield entry["path"], entry["last_modified"].timestamp()

    def answers(self) -> bool:
        """Whether the store answers within a few seconds."""
        try:
            obstore.head(self._probe, PROBE)
        except FileNotFoundError:
            return True
        except BaseError:
            return False
        return True


def _choices() -> dict[str, bool]:
    """What the environment says of the connection: obstore does not look there when it is given options."""
    return {"allow_http": os.environ.get("AWS_ALLOW_HTTP", "").lower() in ("1", "true", "yes")}


def _reason(error: BaseException) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0]


def _sync_folder(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
