"""Patients, who they are, and with whom they are shared."""

from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Annotated, Any
from uuid import UUID

from fastapi import Query, Response
from sqlalchemy import ColumnElement, Select, String, bindparam, case, func, nulls_last, or_, select
from starlette.background import BackgroundTask
from starlette.responses import FileResponse

from ...errors import Conflict
from ...storage.deletion import delete_patient as delete_everything
from ...storage.editing import assign
from ...storage.export import export_patient as write_zip
from ...storage.models import Access, GaitSession, PatientIdentity, PatientShare, Role, User
from ...storage.models import Patient as PatientRow
from .. import visibility
from ..caller import Call
from ..dependencies import Asker, ExpectedVersion, allowed, allowed_slowly, check_version, tag
from ..files import content, disposition
from ..listing import Listing, containing, page
from ..permissions import Permission
from ..problems import Absent
from ..repetition import RepetitionKey, once
from ..results import keep_until_sent
from ..routing import api_router
from ..schemas.forms import Page
from ..schemas.patients import (
    Identity,
    IdentityChange,
    NewPatient,
    Patient,
    PatientChange,
    PatientFilter,
    Share,
    ShareChange,
)

CLEARABLE = frozenset({"retain_until"})
router = api_router("/patients", tag="patients")
Reader = Annotated[Call, allowed(Permission.PATIENTS_READ)]
Writer = Annotated[Call, allowed(Permission.PATIENTS_WRITE)]
IdentityExporter = Annotated[Asker, allowed_slowly(Permission.IDENTITIES_READ)]
IdentityReader = Annotated[Call, allowed(Permission.IDENTITIES_READ)]
IdentityWriter = Annotated[Call, allowed(Permission.IDENTITIES_WRITE)]
Sharer = Annotated[Call, allowed(Permission.SHARES_WRITE)]
"""In the interface of routes, `call` is who asks with what they may reach."""


def _with_visits(sees_all: bool) -> tuple[Select[*tuple[Any, ...]], ColumnElement[Any]]:
    """Patients with the number and the last day of their visits, and whether the caller may change them."""
    visits = (
        select(
            GaitSession.patient_id,
            func.count().label("n_sessions"),
            func.max(GaitSession.visited_on).label("last_visit"),
        )
        .group_by(GaitSession.patient_id)
        .subquery()
    )
    may_write = case((visibility.visible(sees_all, write=True), "write"), else_="read")
    query = select(PatientRow, func.coalesce(visits.c.n_sessions, 0), visits.c.last_visit, may_write).outerjoin(
        visits, visits.c.patient_id == PatientRow.id
    )
    return query.where(visibility.visible(sees_all)), visits.c.last_visit


def _answer(call: Call, row: Any) -> Patient:
    patient, n_sessions, last_visit, access = row
    return Patient(
        id=patient.id,
        created_at=patient.created_at,
        version=patient.version,
        pseudonym=patient.pseudonym,
        sex=patient.sex,
        diagnosis=patient.diagnosis,
        notes=patient.notes if call.caller.sees_names else None,
        retain_until=patient.retain_until,
        n_sessions=n_sessions,
        last_visit=last_visit,
        access=Access(access),
    )


@cache
def _one_patient(sees_all: bool) -> Select[Any]:
    return _with_visits(sees_all)[0].where(PatientRow.id == visibility.OBJECT)


def _one(call: Call, patient_id: UUID) -> Patient:
    return _answer(call, call.find(_one_patient(call.caller.sees_all), object_id=patient_id).one())


@cache
def _listing(sees_all: bool, sees_names: bool, searches: bool, order: str) -> Listing:
    query, last_visit = _with_visits(sees_all)
    if searches:
        query = query.where(_matches(sees_names))
    columns: dict[str, ColumnElement[Any]] = {
        "pseudonym": PatientRow.pseudonym.expression,
        "created_at": PatientRow.created_at.expression,
        "last_visit": last_visit,
    }
    column = columns[order.removeprefix("-")]
    ordered = column.desc() if order.startswith("-") else column.asc()
    return Listing(query.order_by(nulls_last(ordered), PatientRow.id))


def _matches(sees_names: bool) -> ColumnElement[bool]:
    pattern = bindparam("pattern", type_=String())
    own = or_(PatientRow.pseudonym.ilike(pattern), PatientRow.diagnosis.ilike(pattern))
    if not sees_names:
        return own
    identity = select(PatientIdentity.patient_id).where(
        or_(PatientIdentity.name.ilike(pattern), PatientIdentity.record_number.ilike(pattern))
    )
    return or_(own, PatientRow.id.in_(identity))


@router.get("")
def list_patients(call: Reader, which: Annotated[PatientFilter, Query()]) -> Page[Patient]:
    """Patients that the caller may see."""
    rows = _listing(call.caller.sees_all, call.caller.sees_names, bool(which.search), which.order)
    call.audit("list", "patients", detail={"searched": bool(which.search)})
    return page(call, rows, which, lambda row: _answer(call, row), pattern=containing(which.search))


@router.post("", status_code=HTTPStatus.CREATED)
def create_patient(call: Writer, body: NewPatient, response: Response, key: RepetitionKey = None) -> Patient:
    """A new patient under a pseudonym."""

    def make() -> Patient:
        patient = PatientRow(**body.model_dump(), created_by=call.caller.user_id)
        call.db.add(patient)
        call.db.flush()
        call.audit("create", "patients", patient.id, patient.id)
        return _one(call, patient.id)

    made = once(call, key, ("createPatient", body), Patient, make)
    tag(response, made.version)
    return made


@router.get("/{patient_id}")
def get_patient(call: Reader, patient_id: UUID, response: Response) -> Patient:
    """One patient."""
    patient = visibility.patient(call, patient_id, "read")
    tag(response, patient.version)
    return _one(call, patient_id)


@router.patch("/{patient_id}")
def change_patient(
    call: Writer, patient_id: UUID, body: PatientChange, response: Response, expected: ExpectedVersion
) -> Patient:
    """Change what is given."""
    patient = visibility.patient(call, patient_id, "update")
    check_version(patient, expected)
    assign(patient, body.model_dump(exclude_unset=True), CLEARABLE)
    call.db.flush()
    tag(response, patient.version)
    return _one(call, patient_id)


@router.delete("/{patient_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_patient(call: Writer, patient_id: UUID, expected: ExpectedVersion) -> None:
    """Delete a patient with all visits, recordings, results and files; a line in the audit log stays."""
    patient = visibility.patient(call, patient_id, "delete")
    check_version(patient, expected)
    delete_everything(call.services.database, call.services.files, patient_id, call.actor)


@router.get("/{patient_id}/export", response_class=Response, responses=content("application/zip"))
def export_patient(asker: IdentityExporter, patient_id: UUID) -> Response:
    """Everything about one patient as a zip."""
    with asker.begin() as call:
        visibility.patient(call, patient_id, "export")

    def make(folder: Path) -> Path:
        path = folder / f"patient-{patient_id}.zip"
        with path.open("wb") as file:
            write_zip(asker.services.database, asker.services.files, patient_id, file)
        return path

    path, remove = keep_until_sent(asker.services, make)
    headers = {"content-disposition": disposition(path.name)}
    return FileResponse(path, media_type="application/zip", headers=headers, background=BackgroundTask(remove))


@router.get("/{patient_id}/identity")
def get_identity(call: IdentityReader, patient_id: UUID, response: Response) -> Identity:
    """Name, birth date and record number."""
    visibility.patient(call, patient_id, "read", "patient_identities")
    found = call.db.get(PatientIdentity, patient_id)
    if found is None:
        raise Absent("identity of patient", patient_id)
    tag(response, found.version)
    return Identity.model_validate(found)


@router.put("/{patient_id}/identity")
def set_identity(
    call: IdentityWriter, patient_id: UUID, body: IdentityChange, response: Response, expected: ExpectedVersion
) -> Identity:
    """Store who the patient is."""
    visibility.patient(call, patient_id, "update", "patient_identities")
    found = call.db.get(PatientIdentity, patient_id, with_for_update=True)
    if found is None:
        found = PatientIdentity(patient_id=patient_id)
        call.db.add(found)
    else:
        check_version(found, expected)
    for name, value in body.model_dump().items():
        setattr(found, name, value)
    call.db.flush()
    tag(response, found.version)
    return Identity.model_validate(found)


@router.delete("/{patient_id}/identity", status_code=HTTPStatus.NO_CONTENT)
def delete_identity(call: IdentityWriter, patient_id: UUID) -> None:
    """Forget who the patient is; everything else stays under the pseudonym."""
    visibility.patient(call, patient_id, "delete", "patient_identities")
    found = call.db.get(PatientIdentity, patient_id)
    if found is not None:
        call.db.delete(found)


@router.get("/{patient_id}/shares")
def list_shares(call: Sharer, patient_id: UUID) -> list[Share]:
    """Colleagues who may see the patient."""
    visibility.patient(call, patient_id, "read", "patient_shares")
    query = (
        select(PatientShare, User)
        .join(User, User.id == PatientShare.user_id)
        .where(PatientShare.patient_id == patient_id)
        .order_by(User.login)
    )
    return [_share(share, user) for share, user in call.db.execute(query)]


def _share(share: PatientShare, user: User) -> Share:
    return Share(
        user_id=user.id,
        login=user.login,
        display_name=user.display_name,
        access=share.access,
        created_at=share.created_at,
    )


@router.put("/{patient_id}/shares/{user_id}")
def share_patient(call: Sharer, patient_id: UUID, user_id: UUID, body: ShareChange) -> Share:
    """Let a colleague read, or read and write."""
    visibility.patient(call, patient_id, "share", "patient_shares", user_id)
    user = call.db.get(User, user_id)
    if user is None or not user.active:
        raise Absent("user", user_id)
    if user.role in (Role.VIEWER, Role.RESEARCHER) and body.access is Access.WRITE:
        raise Conflict(f"the role {user.role} does not write: share for reading")
    found = call.db.get(PatientShare, (patient_id, user_id), with_for_update=True)
    if found is None:
        found = PatientShare(patient_id=patient_id, user_id=user_id, access=body.access, created_by=call.caller.user_id)
        call.db.add(found)
    found.access = body.access
    call.db.flush()
    return _share(found, user)


@router.delete("/{patient_id}/shares/{user_id}", status_code=HTTPStatus.NO_CONTENT)
def unshare_patient(call: Sharer, patient_id: UUID, user_id: UUID) -> None:
    """Take a colleague's right away."""
    visibility.patient(call, patient_id, "unshare", "patient_shares", user_id)
    found = call.db.get(PatientShare, (patient_id, user_id))
    if found is not None:
        call.db.delete(found)
