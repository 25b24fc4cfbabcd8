"""Videos and documents of visits."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import Header, Query, Response
from sqlalchemy import select, update

from ...storage.models import Attachment as AttachmentRow
from ...storage.models import Upload
from ...storage.references import remove_unused
from .. import visibility
from ..caller import Call
from ..dependencies import Asker, allowed, allowed_slowly
from ..files import content, stream_part
from ..listing import page
from ..permissions import Permission
from ..routing import api_router
from ..schemas.forms import Page, Paging
from ..schemas.patients import Attachment

router = api_router(tag="attachments")
Reader = Annotated[Call, allowed(Permission.IDENTITIES_READ)]
"""Videos show faces."""
ByteRange = Annotated[str | None, Header(alias="Range", max_length=100)]
Remover = Annotated[Asker, allowed_slowly(Permission.PATIENTS_WRITE)]


@router.get("/sessions/{session_id}/attachments")
def list_attachments(call: Reader, session_id: UUID, which: Annotated[Paging, Query()]) -> Page[Attachment]:
    """Videos and documents of a visit."""
    visibility.gait_session(call, session_id, "read", "attachments")
    query = select(AttachmentRow).where(AttachmentRow.session_id == session_id)
    query = query.order_by(AttachmentRow.created_at, AttachmentRow.id)
    return page(call, query, which, lambda row: Attachment.model_validate(row[0]))


@router.get(
    "/attachments/{attachment_id}/file",
    response_class=Response,
    responses=content("*/*") | {206: {"description": "A part of the file.", "content": {"*/*": {}}}},
)
def download_attachment(call: Reader, attachment_id: UUID, part: ByteRange = None) -> Response:
    """The file, or the part that a player asks for."""
    row = visibility.part(call, AttachmentRow, attachment_id, "export")
    return stream_part(call, row, part)


@router.delete("/attachments/{attachment_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_attachment(asker: Remover, attachment_id: UUID) -> None:
    """Delete a video or a document."""
    with asker.begin() as call:
        row = visibility.part(call, AttachmentRow, attachment_id, "delete")
        sha256 = row.sha256
        call.db.execute(update(Upload).where(Upload.attachment_id == attachment_id).values(attachment_id=None))
        call.db.delete(row)
    remove_unused(asker.services.database, asker.services.files, [sha256])
