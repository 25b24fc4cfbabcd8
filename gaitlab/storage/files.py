"""Contents by their SHA-256: a name never means two contents, and every content is verified as it is read."""

import hashlib
import tempfile
from collections.abc import Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol

from ..errors import StorageError
from .encryption import FileKey
from .objects import DiskObjects, RemoteObjects
from .settings import Settings

CHUNK = 1 << 20
"""Bytes read at a time."""


@dataclass(frozen=True, kw_only=True)
class Stored:
    """A content in the store."""

    sha256: str
    size: int


class Objects(Protocol):
    """Where the bytes are kept under names."""

    def write(self, name: str, source: BinaryIO) -> None:
        """Keep a complete file; once this returns it survives a loss of power."""
        ...

    def read(self, name: str) -> Iterator[bytes]:
        """The bytes; raises StorageError if there are none of that name."""
        ...

    def exists(self, name: str) -> bool:
        """Whether there are bytes of that name."""
        ...

    def confirm(self, name: str) -> None:
        """Make sure that bytes that are there survive a loss of power."""
        ...

    def delete(self, name: str) -> None:
        """Remove the bytes of that name, if any."""
        ...

    def names(self) -> Iterator[tuple[str, float]]:
        """All names, each with the time of its writing [s since 1970]."""
        ...

    def answers(self) -> bool:
        """Whether it can be used now; takes a few seconds at most."""
        ...


class FileStore:
    """The contents of an installation."""

    def __init__(self, objects: Objects, spool: Path, key: FileKey | None = None) -> None:
        self._objects, self._spool, self._key = objects, spool, key

    def put(self, chunks: Iterable[bytes]) -> Stored:
        """Keep a content that arrives in pieces; it never lies in memory as a whole. On return it is durable."""
        hashed, size = hashlib.sha256(), 0
        with _spooled(self._spool) as file:
            # The hash is of the plain bytes, the spooled file already has the stored form.
            plain = _Tee(chunks, hashed.update)
            for piece in plain if self._key is None else self._key.encrypt(plain):
                _write(file, piece)
            size = plain.size
            digest = hashed.hexdigest()
            name = self.object_name(digest)
            if self._objects.exists(name):
                self._objects.confirm(name)
            else:
                file.seek(0)
                self._objects.write(name, file)
        return Stored(sha256=digest, size=size)

    def put_file(self, path: Path) -> Stored:
        """Keep a file's content."""
        with path.open("rb") as file:
            return self.put(_pieces(file))

    def open(self, digest: str) -> Iterator[bytes]:
        """The content in pieces.

        Raises:
            StorageError: It is not there, or, after the last piece, its hash is another one.
        """
        raw = self._objects.read(self.object_name(digest))
        hashed = hashlib.sha256()
        for piece in raw if self._key is None else self._key.decrypt(raw):
            hashed.update(piece)
            yield piece
        if hashed.hexdigest() != digest:
            raise StorageError(f"stored file {digest[:12]} is damaged: restore it from a backup")

    def read(self, digest: str) -> bytes:
        """The whole content; for small files."""
        return b"".join(self.open(digest))

    def copy_to(self, digest: str, path: Path) -> None:
        """Write the content to `path`, which is removed again if it turns out to be damaged."""
        try:
            with path.open("wb") as file:
                for piece in self.open(digest):
                    file.write(piece)
        except StorageError:
            path.unlink(missing_ok=True)
            raise

    def exists(self, digest: str) -> bool:
        """Whether the content is there."""
        return self._objects.exists(self.object_name(digest))

    def delete(self, digest: str) -> None:
        """Remove the content, if it is there."""
        self._objects.delete(self.object_name(digest))

    def object_name(self, digest: str) -> str:
        """Name that the content is kept under."""
        return digest if self._key is None else self._key.object_name(digest)

    def names(self) -> Iterator[tuple[str, float]]:
        """Names of everything kept, with the time of its writing [s since 1970]."""
        return self._objects.names()

    def answers(self) -> bool:
        """Whether the store can be used now; takes a few seconds at most."""
        return self._objects.answers()

    def delete_object(self, name: str) -> None:
        """Remove what `names` listed."""
        self._objects.delete(name)

    def clear_spool(self, before: float) -> None:
        """Remove what processes that were killed left half written before a time [s since 1970]."""
        for path in self._spool.iterdir():
            if path.stat().st_mtime < before:
                path.unlink(missing_ok=True)


class _Tee:
    """Passes pieces on, and tells a function of each; counts bytes."""

    def __init__(self, chunks: Iterable[bytes], also: "_Sink") -> None:
        self._chunks, self._also = chunks, also
        self.size = 0

    def __iter__(self) -> Iterator[bytes]:
        for chunk in self._chunks:
            self._also(chunk)
            self.size += len(chunk)
            yield chunk


class _Sink(Protocol):
    def __call__(self, chunk: bytes, /) -> None: ...


def open_store(settings: Settings) -> FileStore:
    """The store that the settings name.

    Raises:
        StorageError: The folder, the address or the key cannot be used.
    """
    key = None if settings.key_file is None else FileKey.load(settings.key_file)
    spool = settings.data_dir / "spool"
    spool.mkdir(mode=0o700, parents=True, exist_ok=True)
    if "://" in settings.files:
        return FileStore(RemoteObjects.open(settings.files), spool, key)
    folder = Path(settings.files) if settings.files else settings.data_dir / "files"
    # The spool must lie in the same file system, or the last step would be a copy and no rename.
    return FileStore(DiskObjects(folder), DiskObjects(folder).spool, key)


@contextmanager
def _spooled(folder: Path) -> Generator[BinaryIO]:
    try:
        file = tempfile.NamedTemporaryFile(dir=folder, prefix="part-")
    except OSError as error:
        raise StorageError(f"the file store cannot be written ({error.strerror})") from error
    with file:
        yield file  # type: ignore[misc]


def _write(file: BinaryIO, piece: bytes) -> None:
    try:
        file.write(piece)
    except OSError as error:
        raise StorageError(f"the file store cannot be written ({error.strerror})") from error


def _pieces(file: BinaryIO) -> Iterator[bytes]:
    while piece := file.read(CHUNK):
        yield piece
