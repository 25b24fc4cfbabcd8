"""A result and its files as rows, in the caller's transaction."""

import mimetypes
from collections.abc import Mapping
from pathlib import Path

from sqlalchemy.orm import Session

from ..storage.files import FileStore, Stored
from ..storage.models import Result, ResultFile
from ..storage.references import refer

MEDIA_TYPES = {".npz": "application/x-npz", ".urdf": "application/xml", ".parquet": "application/vnd.apache.parquet"}


def add_result(session: Session, store: FileStore, result: Result, files: Mapping[str, Stored]) -> None:
    """Add a result with files that the store holds, by their names."""
    # In one order everywhere, or two transactions could wait for each other.
    for stored in sorted(files.values(), key=lambda each: each.sha256):
        refer(session, store, stored)
    session.add(result)
    session.flush()
    session.add_all(
        ResultFile(result_id=result.id, name=name, media_type=media_type(name), sha256=stored.sha256, size=stored.size)
        for name, stored in files.items()
    )


def media_type(name: str) -> str:
    """Media type of a result's file."""
    ending = Path(name).suffix
    return MEDIA_TYPES.get(ending) or mimetypes.guess_type(name)[0] or "application/octet-stream"
