"""Which patients a caller may see, and with them visits, recordings, jobs and results. Every look is audited here.

A patient is visible to administrators, to whoever made it, and to whom it is shared with. All routes fetch patient data
through these functions, so that none can forget the check or the audit line.

To make a statement takes longer than the database takes to answer it. Those that nearly every request asks are
therefore made once: they name the caller and the object by parameters, whose values `Call.find` gives.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any, TypeVar
from uuid import UUID

from sqlalchemy import ColumnElement, Select, Uuid, and_, bindparam, exists, func, or_, select, true
from sqlalchemy.orm import InstrumentedAttribute, aliased

from ..errors import AccessDenied
from ..storage.models import (
    Access,
    Attachment,
    GaitSession,
    Job,
    JobPatient,
    Patient,
    PatientShare,
    Recording,
    ReportVersion,
    Result,
    Subject,
)
from .caller import Call
from .problems import Absent

Part = Recording | Subject | Attachment | ReportVersion
P = TypeVar("P", Recording, Subject, Attachment, ReportVersion)
PatientId = ColumnElement[UUID] | InstrumentedAttribute[UUID]
CALLER = bindparam("caller_id", type_=Uuid())
"""Who asks; `Call.find` gives the value."""
OBJECT = bindparam("object_id", type_=Uuid())
"""What is asked for; to be given to `Call.find`."""
_Own, _OwnJob = aliased(Patient), aliased(Job)


def visible(sees_all: bool, patient_id: PatientId = Patient.id, write: bool = False) -> ColumnElement[bool]:
    """Condition on a query: the patient is visible to the caller, or may be changed by them."""
    if sees_all:
        return true()
    share = and_(PatientShare.patient_id == patient_id, PatientShare.user_id == CALLER)
    if write:
        share = and_(share, PatientShare.access == Access.WRITE)
    mine = and_(_Own.id == patient_id, _Own.created_by == CALLER)
    return or_(exists().where(share), exists().where(mine))


@cache
def _patient(sees_all: bool) -> Select[Any]:
    return select(Patient).where(Patient.id == OBJECT, visible(sees_all))


def patient(call: Call, patient_id: UUID, action: str, kind: str = "patients", what: object = None) -> Patient:
    """A patient, and an audit line; every action but `read` and `export` needs the right to write.

    Raises:
        Absent: There is none, or it is hidden from the caller.
        AccessDenied: It is shared for reading only.
    """
    found = call.find(_patient(call.caller.sees_all), object_id=patient_id).scalar_one_or_none()
    if found is None:
        raise Absent("patient", patient_id)
    require_write(call, patient_id, action)
    call.audit(action, kind, what or patient_id, patient_id)
    return found


READING = frozenset({"read", "export", "analyse", "view"})
"""What may be done with a patient that is shared for reading."""


@cache
def _writable(sees_all: bool) -> Select[Any]:
    return select(exists(Patient.id).where(Patient.id == OBJECT, visible(sees_all, write=True)))


def require_write(call: Call, patient_id: UUID, action: str) -> None:
    """Raise AccessDenied when a patient is shared for reading only and the action changes something."""
    if action in READING:
        return
    if not call.find(_writable(call.caller.sees_all), object_id=patient_id).scalar_one():
        raise AccessDenied(f"patient '{patient_id}' is shared with you for reading only")


@cache
def _gait_session(sees_all: bool) -> Select[Any]:
    return select(GaitSession).where(GaitSession.id == OBJECT, visible(sees_all, GaitSession.patient_id))


def gait_session(call: Call, session_id: UUID, action: str, kind: str = "sessions", what: object = None) -> GaitSession:
    """A visit of a visible patient, and an audit line."""
    found = call.find(_gait_session(call.caller.sees_all), object_id=session_id).scalar_one_or_none()
    if found is None:
        raise Absent("session", session_id)
    require_write(call, found.patient_id, action)
    call.audit(action, kind, what or session_id, found.patient_id)
    return found


@cache
def _part(kind: type[Part], sees_all: bool) -> Select[*tuple[Any, ...]]:
    query = select(kind, GaitSession.patient_id).join(GaitSession, kind.session_id == GaitSession.id)
    return query.where(kind.id == OBJECT, visible(sees_all, GaitSession.patient_id))


def part(call: Call, kind: type[P], object_id: UUID, action: str) -> P:
    """A recording, subject, attachment or report of a visible patient, and an audit line."""
    found = call.find(_part(kind, call.caller.sees_all), object_id=object_id).one_or_none()
    if found is None:
        raise Absent(kind.__name__.lower().removesuffix("version"), object_id)
    row, patient_id = found
    require_write(call, patient_id, action)
    call.audit(action, kind.__tablename__, object_id, patient_id)
    return row


def visible_job(sees_all: bool, job_id: InstrumentedAttribute[UUID] = Job.id) -> ColumnElement[bool]:
    """Condition on a query: all patients of the job are visible; jobs without patients are their maker's."""
    if sees_all:
        return true()
    hidden = exists(JobPatient.job_id).where(JobPatient.job_id == job_id, ~visible(sees_all, JobPatient.patient_id))
    some = exists(JobPatient.job_id).where(JobPatient.job_id == job_id)
    mine = exists().where(_OwnJob.id == job_id, _OwnJob.created_by == CALLER)
    return and_(~hidden, or_(some, mine))


def patients_of(call: Call, job_id: UUID) -> Sequence[UUID]:
    """Patients whose data a job reads."""
    return call.db.scalars(select(JobPatient.patient_id).where(JobPatient.job_id == job_id)).all()


def _with_patients(
    kind: type[Job | Result], job_id: InstrumentedAttribute[UUID], sees_all: bool
) -> Select[*tuple[Any, ...]]:
    """A job or a result, and the patients whose data it comes from."""
    patients = select(func.array_agg(JobPatient.patient_id)).where(JobPatient.job_id == job_id).scalar_subquery()
    return select(kind, patients).where(kind.id == OBJECT, visible_job(sees_all, job_id))


@cache
def _job(sees_all: bool) -> Select[*tuple[Any, ...]]:
    return _with_patients(Job, Job.id, sees_all)


def job(call: Call, job_id: UUID, action: str) -> Job:
    """A job on visible patients, and an audit line for each of them."""
    found = call.find(_job(call.caller.sees_all), object_id=job_id).one_or_none()
    if found is None:
        raise Absent("analysis", job_id)
    _audit_each(call, found[1], action, ("jobs", job_id))
    return found[0]


@cache
def _result(sees_all: bool) -> Select[*tuple[Any, ...]]:
    return _with_patients(Result, Result.job_id, sees_all)


def result(call: Call, result_id: UUID, action: str, kind: str = "results", what: object = None) -> Result:
    """A result on visible patients, and an audit line for each of them."""
    found = call.find(_result(call.caller.sees_all), object_id=result_id).one_or_none()
    if found is None:
        raise Absent("result", result_id)
    _audit_each(call, found[1], action, (kind, what or result_id))
    return found[0]


def _audit_each(call: Call, patients: Sequence[UUID] | None, action: str, what: tuple[str, object]) -> None:
    for patient_id in patients or ():
        require_write(call, patient_id, action)
        call.audit(action, what[0], what[1], patient_id)
    if not patients:
        call.audit(action, *what)


_PATIENT_OF = select(GaitSession.__table__.c.patient_id).where(GaitSession.__table__.c.id == OBJECT)


def patient_of(call: Call, session_id: UUID) -> UUID:
    """The patient of a visit that was found to be visible."""
    return call.find(_PATIENT_OF, object_id=session_id).scalar_one()
