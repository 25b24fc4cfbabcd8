"""Stored contents as answers, and bodies of requests as files, never as a whole in memory."""

import hashlib
import re
import tempfile
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any
from urllib.parse import quote

from fastapi import Request
from sqlalchemy import select
from starlette.responses import Response, StreamingResponse

from ..errors import InvalidRequest, TooLarge
from ..storage.models import Attachment, StoredFile
from .caller import Call
from .services import Services

CHUNK_LIMIT = 8 << 20
"""Largest chunk of a resumable upload [bytes]."""
SMALL = 1 << 20
"""Contents of up to so many bytes are read and verified before their answer begins [bytes]."""
BINARY = {"schema": {"type": "string", "format": "binary"}}


def content(*media_types: str) -> dict[int | str, dict[str, Any]]:
    """Entry of the OpenAPI document for an answer that is a file."""
    return {200: {"description": "The file.", "content": {kind: _schema(kind) for kind in media_types}}}


def _schema(media_type: str) -> dict[str, Any]:
    return {"schema": {"type": "object"}} if media_type.endswith("json") else BINARY


def body_of(media_type: str = "application/octet-stream") -> dict[str, Any]:
    """Entry of the OpenAPI document for a request whose body is a file."""
    return {"requestBody": {"required": True, "content": {media_type: BINARY}}}


def disposition(name: str, inline: bool = False) -> str:
    """Header that names a download; every name survives it (RFC 6266)."""
    plain = re.sub(r"[^A-Za-z0-9._-]", "_", name) or "file"
    return f"{'inline' if inline else 'attachment'}; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"


def stream(call: Call, sha256: str, media_type: str, name: str, size: int | None = None, **headers: str) -> Response:
    """A stored file as an answer, of `size` bytes if known; its hash is its ETag, because a content never changes."""
    if size is None:
        size = call.db.scalar(select(StoredFile.size).where(StoredFile.sha256 == sha256))
    told = {
        "content-disposition": disposition(name),
        "etag": f'"{sha256}"',
        "cache-control": "private, no-cache",
        **{key.replace("_", "-"): value for key, value in headers.items()},
    }
    if size is not None and size <= SMALL:
        return Response(call.services.files.read(sha256), media_type=media_type, headers=told)
    if size is not None:
        told["content-length"] = str(size)
    return StreamingResponse(call.services.files.open(sha256), media_type=media_type, headers=told)


_PART = re.compile(r"bytes=(\d{1,15})-(\d{0,15})$")


def stream_part(call: Call, row: Attachment, wanted: str | None) -> Response:
    """A stored file, or the part of it that a player asks for (RFC 9110, section 14); other ranges get the whole."""
    found = _PART.match(wanted or "")
    first = int(found[1]) if found else 0
    last = min(int(found[2]), row.size - 1) if found and found[2] else row.size - 1
    if found is None or first > last:
        return stream(call, row.sha256, row.media_type, row.name, row.size, accept_ranges="bytes")
    headers = {
        "content-disposition": disposition(row.name),
        "content-range": f"bytes {first}-{last}/{row.size}",
        "content-length": str(last - first + 1),
        "accept-ranges": "bytes",
        "etag": f'"{row.sha256}"',
    }
    part = _between(call.services.files.open(row.sha256), first, last + 1)
    return StreamingResponse(part, 206, headers=headers, media_type=row.media_type)


def _between(chunks: Iterator[bytes], start: int, end: int) -> Iterator[bytes]:
    place = 0
    for chunk in chunks:
        if place + len(chunk) > start:
            yield chunk[max(start - place, 0) : end - place]
        place += len(chunk)
        if place >= end:
            return


@contextmanager
def spool(services: Services) -> Generator[IO[bytes]]:
    """A temporary file in the data folder, gone at the end."""
    folder = services.settings.data_dir / "incoming"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=folder, prefix="upload-") as file:
        yield file


async def receive(request: Request, file: IO[bytes], limit: int) -> tuple[int, str]:
    """Write a request's body to `file` as it arrives; returns its size and SHA-256.

    Raises:
        TooLarge: More than `limit` bytes, announced or sent.
        InvalidRequest: It ends early, or has no bytes.
    """
    announced = request.headers.get("content-length", "")
    if announced.isdigit() and int(announced) > limit:
        raise TooLarge(_too_large(int(announced), limit))
    size, digest = 0, hashlib.sha256()
    async for piece in request.stream():
        size += len(piece)
        if size > limit:
            raise TooLarge(_too_large(size, limit))
        digest.update(piece)
        file.write(piece)
    if size == 0:
        raise InvalidRequest("the request has no body: send the bytes of the file")
    file.flush()
    return size, digest.hexdigest()


def _too_large(size: int, limit: int) -> str:
    return f"{size / 1e6:.1f} MB were sent, the limit is {limit / 1e6:.1f} MB"


def copy_out(services: Services, sha256: str, folder: Path, name: str) -> Path:
    """Copy of a stored file inside `folder`; raises InvalidRequest for a name that leads out of it."""
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise InvalidRequest(f"{name} is no name of a file inside a result")
    path.parent.mkdir(parents=True, exist_ok=True)
    services.files.copy_to(sha256, path)
    return path


def pieces(services: Services, digests: list[str]) -> Iterator[bytes]:
    """Contents one after the other."""
    for digest in digests:
        yield from services.files.open(digest)
