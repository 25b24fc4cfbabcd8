"""Files that have arrived: chunks of uploads, and the recordings and attachments they become."""

import re
from pathlib import Path
from uuid import UUID

from sqlalchemy import delete, func, select

from ..errors import Conflict, InvalidRecording, InvalidRequest, TooLarge
from ..mocap.header import check_file
from ..storage.files import Stored
from ..storage.models import Attachment, Recording, RecordingKind, Upload, UploadChunk, UploadState
from ..storage.references import refer
from ..storage.schema import now
from . import visibility
from .caller import Call
from .orders import order_inspection
from .problems import Absent

_STATIC = re.compile(r"(^|[^a-z])(static|stat|cal|calibration|standing|stand)([^a-z]|$)", re.IGNORECASE)


def is_recording(name: str) -> bool:
    """Whether a file's name says that it is a C3D file."""
    return name.lower().endswith(".c3d")


def limit_of(call: Call, name: str) -> int:
    """Most bytes that a file of this name may have."""
    settings = call.services.settings
    return settings.max_recording_bytes if is_recording(name) else settings.max_upload_bytes


def check_size(call: Call, name: str, size: int) -> None:
    """Raise TooLarge for a file that is announced with too many bytes."""
    limit = limit_of(call, name)
    if size > limit:
        raise TooLarge(f"{name} has {size / 1e6:.0f} MB, the limit is {limit / 1e6:.0f} MB")


def upload_of(call: Call, upload_id: UUID, lock: bool = False) -> Upload:
    """An upload of the caller's own; raises Absent."""
    query = select(Upload).where(Upload.id == upload_id, Upload.user_id == call.caller.user_id)
    found = call.db.scalars(query.with_for_update() if lock else query).one_or_none()
    if found is None:
        raise Absent("upload", upload_id)
    return found


def received(call: Call, upload: Upload) -> int:
    """Bytes that are safe."""
    if upload.state is UploadState.FINISHED:
        return upload.size
    query = select(func.coalesce(func.sum(UploadChunk.size), 0)).where(UploadChunk.upload_id == upload.id)
    return int(call.db.scalar(query) or 0)


def check_open(upload: Upload) -> None:
    """Raise Conflict for an upload that takes no more bytes."""
    if upload.state is not UploadState.OPEN or upload.expires_at <= now():
        raise Conflict("the upload was finished, given up or has expired: begin a new one")


def add_chunk(call: Call, upload_id: UUID, offset: int, stored: Stored) -> Upload:
    """Note a chunk whose bytes are safe; a chunk that was noted before is left as it is.

    Raises:
        Conflict: Other bytes are expected at this time.
    """
    upload = upload_of(call, upload_id, lock=True)
    check_open(upload)
    refer(call.db, call.services.files, stored)
    present = call.db.get(UploadChunk, (upload_id, offset))
    if present is not None:
        if present.sha256 != stored.sha256:
            raise Conflict(f"other bytes arrived at offset {offset} before: begin a new upload")
        return upload
    expected = received(call, upload)
    if offset != expected:
        raise Conflict(f"the next chunk begins at byte {expected}, not {offset}", expected)
    if offset + stored.size > upload.size:
        raise InvalidRequest(f"the file was announced with {upload.size} bytes; this chunk goes beyond them")
    call.db.add(UploadChunk(upload_id=upload_id, offset=offset, size=stored.size, sha256=stored.sha256))
    call.db.flush()
    return upload


def chunks_of(call: Call, upload: Upload) -> list[str]:
    """Contents of the chunks in order; raises Conflict when some are missing."""
    have = received(call, upload)
    if have != upload.size:
        raise Conflict(f"{have} of {upload.size} bytes have arrived: send the rest first", have)
    query = select(UploadChunk.sha256).where(UploadChunk.upload_id == upload.id).order_by(UploadChunk.offset)
    return list(call.db.scalars(query))


def check_recording(path: Path, name: str, largest: int) -> None:
    """Look at the header, without native code; raises InvalidRecording with the file's name instead of its path."""
    try:
        check_file(path, largest)
    except InvalidRecording as error:
        raise InvalidRecording(str(error).replace(str(path), name)) from error


def add_recording(call: Call, session_id: UUID, name: str, stored: Stored) -> Recording:
    """A recording of a visit, and the job that looks into it."""
    visit = visibility.gait_session(call, session_id, "create", "recordings")
    refer(call.db, call.services.files, stored)
    recording = Recording(
        session_id=session_id,
        name=name,
        kind=RecordingKind.STATIC if _STATIC.search(Path(name).stem) else RecordingKind.WALK,
        sha256=stored.sha256,
        size=stored.size,
        created_by=call.caller.user_id,
    )
    call.db.add(recording)
    call.db.flush()
    order_inspection(call, recording, visit.patient_id)
    return recording


def add_attachment(call: Call, session_id: UUID, name: str, media_type: str, stored: Stored) -> Attachment:
    """A video or a document of a visit."""
    visibility.gait_session(call, session_id, "create", "attachments")
    refer(call.db, call.services.files, stored)
    attachment = Attachment(
        session_id=session_id,
        name=name,
        media_type=media_type,
        sha256=stored.sha256,
        size=stored.size,
        created_by=call.caller.user_id,
    )
    call.db.add(attachment)
    call.db.flush()
    return attachment


def finish(call: Call, upload: Upload, stored: Stored) -> None:
    """Make a recording or an attachment of a complete upload."""
    if is_recording(upload.name):
        upload.recording_id = add_recording(call, upload.session_id, upload.name, stored).id
    else:
        attachment = add_attachment(call, upload.session_id, upload.name, upload.media_type, stored)
        upload.attachment_id = attachment.id
    upload.state, upload.sha256 = UploadState.FINISHED, stored.sha256
    call.db.execute(delete(UploadChunk).where(UploadChunk.upload_id == upload.id))
    call.db.flush()
