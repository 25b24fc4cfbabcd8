"""Visits to the laboratory."""

from datetime import date
from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import Query, Response
from sqlalchemy import select

from ...storage.deletion import delete_session as delete_everything
from ...storage.editing import assign
from ...storage.models import GaitSession, PatientIdentity
from .. import visibility
from ..caller import Call
from ..dependencies import ExpectedVersion, allowed, check_version, tag
from ..listing import Listing, page
from ..permissions import Permission
from ..repetition import RepetitionKey, once
from ..routing import api_router
from ..schemas.forms import Page, Paging
from ..schemas.patients import NewSession, Session, SessionChange, SessionFilter

DAYS_PER_YEAR = 365.2425
CLEARABLE = frozenset({"age_years"})
router = api_router(tag="sessions")
Reader = Annotated[Call, allowed(Permission.PATIENTS_READ)]
Writer = Annotated[Call, allowed(Permission.PATIENTS_WRITE)]


def _answer(call: Call, row: GaitSession) -> Session:
    answer = Session.model_validate(row)
    return answer if call.caller.sees_names else answer.model_copy(update={"notes": None})


@router.get("/sessions")
def list_sessions(call: Reader, which: Annotated[SessionFilter, Query()]) -> Page[Session]:
    """Visits of all patients that the caller may see, newest first."""
    query = select(GaitSession).where(visibility.visible(call.caller.sees_all, GaitSession.patient_id))
    if which.patient_id is not None:
        query = query.where(GaitSession.patient_id == which.patient_id)
    call.audit("list", "sessions", patient_id=which.patient_id)
    query = query.order_by(GaitSession.visited_on.desc(), GaitSession.id)
    return page(call, query, which, lambda row: _answer(call, row[0]))


_OF_PATIENT = Listing(
    select(GaitSession)
    .where(GaitSession.patient_id == visibility.OBJECT)
    .order_by(GaitSession.visited_on, GaitSession.created_at)
)


@router.get("/patients/{patient_id}/sessions")
def list_patient_sessions(call: Reader, patient_id: UUID, which: Annotated[Paging, Query()]) -> Page[Session]:
    """Visits of one patient, oldest first, as on a time line."""
    visibility.patient(call, patient_id, "read", "sessions")
    return page(call, _OF_PATIENT, which, lambda row: _answer(call, row[0]), object_id=patient_id)


@router.post("/patients/{patient_id}/sessions", status_code=HTTPStatus.CREATED)
def create_session(
    call: Writer, patient_id: UUID, body: NewSession, response: Response, key: RepetitionKey = None
) -> Session:
    """A new visit."""

    def make() -> Session:
        visibility.patient(call, patient_id, "create", "sessions")
        values = body.model_dump()
        values["age_years"] = body.age_years if body.age_years is not None else _age(call, patient_id, body.visited_on)
        row = GaitSession(patient_id=patient_id, **values)
        call.db.add(row)
        call.db.flush()
        return _answer(call, row)

    made = once(call, key, (f"createSession {patient_id}", body), Session, make)
    tag(response, made.version)
    return made


def _age(call: Call, patient_id: UUID, day: date) -> float | None:
    """Age at the visit [years], where the birth date is known and lies before it."""
    identity = call.db.get(PatientIdentity, patient_id)
    if identity is None or identity.birth_date is None or identity.birth_date > day:
        return None
    return round((day - identity.birth_date).days / DAYS_PER_YEAR, 1)


@router.get("/sessions/{session_id}")
def get_session_of_patient(call: Reader, session_id: UUID, response: Response) -> Session:
    """One visit."""
    row = visibility.gait_session(call, session_id, "read")
    tag(response, row.version)
    return _answer(call, row)


@router.patch("/sessions/{session_id}")
def change_session(
    call: Writer, session_id: UUID, body: SessionChange, response: Response, expected: ExpectedVersion
) -> Session:
    """Change what is given."""
    row = visibility.gait_session(call, session_id, "update")
    check_version(row, expected)
    assign(row, body.model_dump(exclude_unset=True), CLEARABLE)
    call.db.flush()
    tag(response, row.version)
    return _answer(call, row)


@router.delete("/sessions/{session_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_session(call: Writer, session_id: UUID, expected: ExpectedVersion) -> None:
    """Delete a visit with its recordings, results and files."""
    row = visibility.gait_session(call, session_id, "delete")
    check_version(row, expected)
    delete_everything(call.services.database, call.services.files, session_id, call.actor)
