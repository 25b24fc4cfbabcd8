"""Recordings of visits: their role, their content, the names in their headers."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import Query, Response
from sqlalchemy import select, update

from ...mocap.anonymise import blank_personal_entries
from ...storage.models import Recording as RecordingRow
from ...storage.models import Upload
from ...storage.references import refer, remove_unused
from .. import visibility
from ..arrivals import Path
from ..caller import Call
from ..dependencies import Asker, ExpectedVersion, allowed, allowed_slowly, check_version, tag
from ..files import content, spool, stream
from ..listing import page
from ..orders import order_inspection
from ..permissions import Permission
from ..pseudonyms import mask, masked_names
from ..routing import api_router
from ..schemas.forms import Page, Paging
from ..schemas.patients import Recording, RecordingChange, StrippedRecording

router = api_router(tag="recordings")
Reader = Annotated[Call, allowed(Permission.PATIENTS_READ)]
Writer = Annotated[Call, allowed(Permission.PATIENTS_WRITE)]
FileReader = Annotated[Call, allowed(Permission.IDENTITIES_READ)]
Stripper = Annotated[Asker, allowed_slowly(Permission.PATIENTS_WRITE)]
C3D = "application/octet-stream"


def recording_answer(call: Call, row: RecordingRow) -> Recording:
    """A recording; file names may be names of persons, so some see numbers instead."""
    answer = Recording.model_validate(row)
    if call.caller.sees_names:
        return answer
    masks = masked_names(call, [row.session_id])
    told = {"name": f"{masks[Path(row.name).stem]}.c3d", "inspection": mask(row.inspection, masks)}
    return answer.model_copy(update=told)


@router.get("/sessions/{session_id}/recordings")
def list_recordings(call: Reader, session_id: UUID, which: Annotated[Paging, Query()]) -> Page[Recording]:
    """Recordings of a visit, in the order in which they arrived."""
    visibility.gait_session(call, session_id, "read", "recordings")
    query = select(RecordingRow).where(RecordingRow.session_id == session_id)
    query = query.order_by(RecordingRow.created_at, RecordingRow.id)
    return page(call, query, which, lambda row: recording_answer(call, row[0]))


@router.get("/recordings/{recording_id}")
def get_recording(call: Reader, recording_id: UUID, response: Response) -> Recording:
    """One recording."""
    row = visibility.part(call, RecordingRow, recording_id, "read")
    tag(response, row.version)
    return recording_answer(call, row)


@router.patch("/recordings/{recording_id}")
def change_recording(
    call: Writer, recording_id: UUID, body: RecordingChange, response: Response, expected: ExpectedVersion
) -> Recording:
    """Correct its name, or what it shows."""
    row = visibility.part(call, RecordingRow, recording_id, "update")
    check_version(row, expected)
    row.name = body.name or row.name
    row.kind = body.kind or row.kind
    call.db.flush()
    tag(response, row.version)
    return recording_answer(call, row)


@router.delete("/recordings/{recording_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_recording(asker: Stripper, recording_id: UUID, expected: ExpectedVersion) -> None:
    """Delete a recording; results computed from it stay."""
    with asker.begin() as call:
        row = visibility.part(call, RecordingRow, recording_id, "delete")
        check_version(row, expected)
        sha256 = row.sha256
        call.db.execute(update(Upload).where(Upload.recording_id == recording_id).values(recording_id=None))
        call.db.delete(row)
    remove_unused(asker.services.database, asker.services.files, [sha256])


@router.get("/recordings/{recording_id}/file", response_class=Response, responses=content(C3D))
def download_recording(call: FileReader, recording_id: UUID) -> Response:
    """The C3D file as it is stored."""
    row = visibility.part(call, RecordingRow, recording_id, "export")
    return stream(call, row.sha256, C3D, row.name, row.size)


@router.post("/recordings/{recording_id}/strip")
def strip_recording(
    asker: Stripper, recording_id: UUID, response: Response, expected: ExpectedVersion
) -> StrippedRecording:
    """Blank names and birth dates in the header; the file is replaced, the old content is removed."""
    services = asker.services
    with asker.begin() as call:
        row = visibility.part(call, RecordingRow, recording_id, "update")
        check_version(row, expected)
        before, version = row.sha256, row.version
    with spool(services) as file:
        path = Path(file.name)
        services.files.copy_to(before, path)
        blanked = blank_personal_entries(path)
        stored = services.files.put_file(path)
    with asker.begin() as call:
        row = visibility.part(call, RecordingRow, recording_id, "update")
        check_version(row, version)
        if blanked:
            refer(call.db, services.files, stored)
            row.sha256, row.size, row.personal_entries, row.inspection = stored.sha256, stored.size, [], None
            call.db.flush()
            order_inspection(call, row, visibility.patient_of(call, row.session_id))
        answer = StrippedRecording(recording=recording_answer(call, row), blanked=blanked)
        tag(response, row.version)
    if blanked:
        remove_unused(services.database, services.files, [before])
    return answer
