"""Body measurements of visits."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import Query, Response
from sqlalchemy import select

from ...storage.models import Subject as SubjectRow
from .. import visibility
from ..caller import Call
from ..dependencies import ExpectedVersion, allowed, check_version, tag
from ..files import content, stream
from ..listing import page
from ..permissions import Permission
from ..problems import Absent
from ..repetition import RepetitionKey, once
from ..routing import api_router
from ..schemas.forms import Page, Paging
from ..schemas.patients import NewSubject, Subject, SubjectChange

router = api_router(tag="subjects")
Reader = Annotated[Call, allowed(Permission.PATIENTS_READ)]
Writer = Annotated[Call, allowed(Permission.PATIENTS_WRITE)]


def _answer(row: SubjectRow) -> Subject:
    return Subject(
        id=row.id,
        created_at=row.created_at,
        version=row.version,
        session_id=row.session_id,
        name=row.name,
        parameters=row.parameters,
        has_model=row.model_sha256 is not None,
    )


@router.get("/sessions/{session_id}/subjects")
def list_subjects(call: Reader, session_id: UUID, which: Annotated[Paging, Query()]) -> Page[Subject]:
    """Body measurements of a visit, newest first."""
    visibility.gait_session(call, session_id, "read", "subjects")
    query = select(SubjectRow).where(SubjectRow.session_id == session_id)
    query = query.order_by(SubjectRow.created_at.desc(), SubjectRow.id)
    return page(call, query, which, lambda row: _answer(row[0]))


@router.post("/sessions/{session_id}/subjects", status_code=HTTPStatus.CREATED)
def create_subject(
    call: Writer, session_id: UUID, body: NewSubject, response: Response, key: RepetitionKey = None
) -> Subject:
    """New body measurements."""

    def make() -> Subject:
        visibility.gait_session(call, session_id, "create", "subjects")
        row = SubjectRow(session_id=session_id, name=body.name, parameters=dict(body.parameters))
        call.db.add(row)
        call.db.flush()
        return _answer(row)

    made = once(call, key, (f"createSubject {session_id}", body), Subject, make)
    tag(response, made.version)
    return made


@router.get("/subjects/{subject_id}")
def get_subject(call: Reader, subject_id: UUID, response: Response) -> Subject:
    """Body measurements."""
    row = visibility.part(call, SubjectRow, subject_id, "read")
    tag(response, row.version)
    return _answer(row)


@router.patch("/subjects/{subject_id}")
def change_subject(
    call: Writer, subject_id: UUID, body: SubjectChange, response: Response, expected: ExpectedVersion
) -> Subject:
    """Change what is given; parameters are replaced as a whole, and a model made of the old ones is dropped."""
    row = visibility.part(call, SubjectRow, subject_id, "update")
    check_version(row, expected)
    if body.name is not None:
        row.name = body.name
    if body.parameters is not None:
        row.parameters, row.model_sha256 = dict(body.parameters), None
    call.db.flush()
    tag(response, row.version)
    return _answer(row)


@router.delete("/subjects/{subject_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_subject(call: Writer, subject_id: UUID, expected: ExpectedVersion) -> None:
    """Delete body measurements; results that used them keep their own copy."""
    row = visibility.part(call, SubjectRow, subject_id, "delete")
    check_version(row, expected)
    call.db.delete(row)


@router.get("/subjects/{subject_id}/model", response_class=Response, responses=content("application/xml"))
def get_subject_model(call: Reader, subject_id: UUID) -> Response:
    """The multibody model as URDF."""
    row = visibility.part(call, SubjectRow, subject_id, "export")
    if row.model_sha256 is None:
        raise Absent("model of subject", subject_id)
    return stream(call, row.model_sha256, "application/xml", f"subject-{subject_id}.urdf")
