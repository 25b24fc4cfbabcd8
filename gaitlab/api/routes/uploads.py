"""Uploads that can be resumed: announce a file, send it chunk by chunk, finish it."""

from datetime import timedelta
from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import Path, Request
from sqlalchemy import delete, select
from starlette.concurrency import run_in_threadpool

from ...errors import InvalidRequest
from ...storage.files import Stored
from ...storage.models import Recording as RecordingRow
from ...storage.models import Upload as UploadRow
from ...storage.models import UploadChunk, UploadState
from ...storage.references import remove_unused
from ...storage.schema import now
from .. import arrivals, visibility
from ..caller import Call
from ..dependencies import Asker, allowed, allowed_slowly
from ..files import CHUNK_LIMIT, body_of, pieces, receive, spool
from ..permissions import Permission
from ..repetition import RepetitionKey, once
from ..routing import api_router
from ..schemas.forms import FURTHEST, FileName
from ..schemas.patients import NewUpload, Recording, Upload
from .recordings import recording_answer

router = api_router(tag="uploads")
Writer = Annotated[Call, allowed(Permission.PATIENTS_WRITE)]
Sender = Annotated[Asker, allowed_slowly(Permission.PATIENTS_WRITE)]
Offset = Annotated[int, Path(ge=0, le=FURTHEST * 10**6, description="First byte of the chunk in the file.")]


def _answer(call: Call, row: UploadRow) -> Upload:
    return Upload(
        id=row.id,
        created_at=row.created_at,
        session_id=row.session_id,
        name=row.name,
        media_type=row.media_type,
        size=row.size,
        received=arrivals.received(call, row),
        state=row.state,
        expires_at=row.expires_at,
        recording_id=row.recording_id,
        attachment_id=row.attachment_id,
        chunk_size=CHUNK_LIMIT,
    )


@router.get("/uploads")
def list_uploads(call: Writer) -> list[Upload]:
    """One's own uploads that can be resumed."""
    query = select(UploadRow).where(
        UploadRow.user_id == call.caller.user_id, UploadRow.state == UploadState.OPEN, UploadRow.expires_at > now()
    )
    return [_answer(call, row) for row in call.db.scalars(query.order_by(UploadRow.created_at))]


@router.post("/uploads", status_code=HTTPStatus.CREATED)
def create_upload(call: Writer, body: NewUpload, key: RepetitionKey = None) -> Upload:
    """Announce a file."""

    def make() -> Upload:
        visibility.gait_session(call, body.session_id, "create", "uploads")
        arrivals.check_size(call, body.name, body.size)
        expires = now() + timedelta(hours=call.services.settings.upload_hours)
        row = UploadRow(**body.model_dump(), user_id=call.caller.user_id, expires_at=expires)
        call.db.add(row)
        call.db.flush()
        return _answer(call, row)

    return once(call, key, ("createUpload", body), Upload, make)


@router.get("/uploads/{upload_id}")
def get_upload(call: Writer, upload_id: UUID) -> Upload:
    """How much of a file has arrived, to go on after a broken connection."""
    return _answer(call, arrivals.upload_of(call, upload_id))


@router.put("/uploads/{upload_id}/chunks/{offset}", openapi_extra=body_of())
async def send_chunk(request: Request, asker: Sender, upload_id: UUID, offset: Offset) -> Upload:
    """Send a part of the file. Once this is answered, the part is safe; sending it again does no harm."""

    def check() -> None:
        with asker.begin() as call:
            arrivals.check_open(arrivals.upload_of(call, upload_id))

    await run_in_threadpool(check)
    with spool(asker.services) as file:
        await receive(request, file, CHUNK_LIMIT)

        def keep() -> Upload:
            file.seek(0)
            stored = asker.services.files.put(iter(lambda: file.read(1 << 20), b""))
            with asker.begin() as call:
                return _answer(call, arrivals.add_chunk(call, upload_id, offset, stored))

        return await run_in_threadpool(keep)


@router.post("/uploads/{upload_id}/finish", status_code=HTTPStatus.CREATED)
def finish_upload(asker: Sender, upload_id: UUID) -> Upload:
    """Put the parts together: a recording, which a job then looks into, or an attachment."""
    with asker.begin() as call:
        upload = arrivals.upload_of(call, upload_id)
        if upload.state is UploadState.FINISHED:
            return _answer(call, upload)
        arrivals.check_open(upload)
        chunks, name, announced = arrivals.chunks_of(call, upload), upload.name, upload.sha256
    stored = _assemble(asker, chunks, name)
    if announced is not None and stored.sha256 != announced:
        raise InvalidRequest("the file has another SHA-256 than announced: it was changed on its way, send it again")
    with asker.begin() as call:
        upload = arrivals.upload_of(call, upload_id, lock=True)
        if upload.state is not UploadState.FINISHED:
            arrivals.finish(call, upload, stored)
        answer = _answer(call, upload)
    remove_unused(asker.services.database, asker.services.files, chunks)
    return answer


def _assemble(asker: Asker, chunks: list[str], name: str) -> Stored:
    services = asker.services
    if not arrivals.is_recording(name):
        return services.files.put(pieces(services, chunks))
    with spool(services) as file:
        for piece in pieces(services, chunks):
            file.write(piece)
        file.flush()
        path = arrivals.Path(file.name)
        arrivals.check_recording(path, name, services.settings.max_recording_bytes)
        return services.files.put_file(path)


@router.delete("/uploads/{upload_id}", status_code=HTTPStatus.NO_CONTENT)
def abandon_upload(asker: Sender, upload_id: UUID) -> None:
    """Give an upload up; what has arrived is removed."""
    with asker.begin() as call:
        upload = arrivals.upload_of(call, upload_id, lock=True)
        chunks = list(call.db.scalars(select(UploadChunk.sha256).where(UploadChunk.upload_id == upload_id)))
        call.db.execute(delete(UploadChunk).where(UploadChunk.upload_id == upload_id))
        if upload.state is UploadState.OPEN:
            upload.state = UploadState.ABANDONED
    remove_unused(asker.services.database, asker.services.files, chunks)


@router.post("/sessions/{session_id}/recordings", status_code=HTTPStatus.CREATED, openapi_extra=body_of())
async def create_recording(request: Request, asker: Sender, session_id: UUID, name: FileName) -> Recording:
    """Send a whole C3D file in one request; it is written to disk as it arrives."""
    limit = asker.services.settings.max_recording_bytes

    def check() -> None:
        with asker.begin() as call:
            visibility.gait_session(call, session_id, "create", "recordings")

    await run_in_threadpool(check)
    with spool(asker.services) as file:
        await receive(request, file, limit)

        def keep() -> Recording:
            path = arrivals.Path(file.name)
            arrivals.check_recording(path, name, limit)
            stored = asker.services.files.put_file(path)
            with asker.begin() as call:
                row: RecordingRow = arrivals.add_recording(call, session_id, name, stored)
                return recording_answer(call, row)

        return await run_in_threadpool(keep)
