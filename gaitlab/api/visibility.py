"""Which patients a caller may see, and with them visits, recordings, jobs and results. Every look is audited here.

A patient is visible to administrators, to whoever made it, and to whom it is shared with. All routes fetch patient data
through these functions, so that none can forget the check or the audit line.
"""

from collections.abc import Sequence
from typing import TypeVar
from uuid import UUID

from sqlalchemy import ColumnElement, and_, exists, or_, select, true
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
    Role,
    Subject,
)
from .caller import Call
from .problems import Absent

Part = Recording | Subject | Attachment | ReportVersion
P = TypeVar("P", Recording, Subject, Attachment, ReportVersion)
PatientId = ColumnElement[UUID] | InstrumentedAttribute[UUID]
_Own, _OwnJob = aliased(Patient), aliased(Job)


def visible(call: Call, patient_id: PatientId = Patient.id, write: bool = False) -> ColumnElement[bool]:
    """Condition on a query: the patient is visible to the caller, or may be changed by them."""
    if call.caller.role is Role.ADMIN:
        return true()
    share = and_(PatientShare.patient_id == patient_id, PatientShare.user_id == call.caller.user_id)
    if write:
        share = and_(share, PatientShare.access == Access.WRITE)
    mine = and_(_Own.id == patient_id, _Own.created_by == call.caller.user_id)
    return or_(exists().where(share), exists().where(mine))


def patient(call: Call, patient_id: UUID, action: str, kind: str = "patients", what: object = None) -> Patient:
    """A patient, and an audit line; every action but `read` and `export` needs the right to write.

    Raises:
        Absent: There is none, or it is hidden from the caller.
        AccessDenied: It is shared for reading only.
    """
    found = call.db.scalars(select(Patient).where(Patient.id == patient_id, visible(call))).one_or_none()
    if found is None:
        raise Absent("patient", patient_id)
    require_write(call, patient_id, action)
    call.audit(action, kind, what or patient_id, patient_id)
    return found


READING = frozenset({"read", "export", "analyse", "view"})
"""What may be done with a patient that is shared for reading."""


def require_write(call: Call, patient_id: UUID, action: str) -> None:
    """Raise AccessDenied when a patient is shared for reading only and the action changes something."""
    if action in READING:
        return
    query = select(exists(Patient.id).where(Patient.id == patient_id, visible(call, write=True)))
    if not call.db.scalar(query):
        raise AccessDenied(f"patient '{patient_id}' is shared with you for reading only")


def gait_session(call: Call, session_id: UUID, action: str, kind: str = "sessions", what: object = None) -> GaitSession:
    """A visit of a visible patient, and an audit line."""
    query = select(GaitSession).where(GaitSession.id == session_id, visible(call, GaitSession.patient_id))
    found = call.db.scalars(query).one_or_none()
    if found is None:
        raise Absent("session", session_id)
    require_write(call, found.patient_id, action)
    call.audit(action, kind, what or session_id, found.patient_id)
    return found


def part(call: Call, kind: type[P], object_id: UUID, action: str) -> P:
    """A recording, subject, attachment or report of a visible patient, and an audit line."""
    query = (
        select(kind, GaitSession.patient_id)
        .join(GaitSession, kind.session_id == GaitSession.id)
        .where(kind.id == object_id, visible(call, GaitSession.patient_id))
    )
    found = call.db.execute(query).one_or_none()
    if found is None:
        raise Absent(kind.__name__.lower().removesuffix("version"), object_id)
    row, patient_id = found
    require_write(call, patient_id, action)
    call.audit(action, kind.__tablename__, object_id, patient_id)
    return row


def visible_job(call: Call, job_id: InstrumentedAttribute[UUID] = Job.id) -> ColumnElement[bool]:
    """Condition on a query: all patients of the job are visible; jobs without patients are their maker's."""
    if call.caller.role is Role.ADMIN:
        return true()
    hidden = exists(JobPatient.job_id).where(JobPatient.job_id == job_id, ~visible(call, JobPatient.patient_id))
    some = exists(JobPatient.job_id).where(JobPatient.job_id == job_id)
    mine = exists().where(_OwnJob.id == job_id, _OwnJob.created_by == call.caller.user_id)
    return and_(~hidden, or_(some, mine))


def patients_of(call: Call, job_id: UUID) -> Sequence[UUID]:
    """Patients whose data a job reads."""
    return call.db.scalars(select(JobPatient.patient_id).where(JobPatient.job_id == job_id)).all()


def job(call: Call, job_id: UUID, action: str) -> Job:
    """A job on visible patients, and an audit line for each of them."""
    found = call.db.scalars(select(Job).where(Job.id == job_id, visible_job(call))).one_or_none()
    if found is None:
        raise Absent("analysis", job_id)
    _audit_each(call, job_id, action, ("jobs", job_id))
    return found


def result(call: Call, result_id: UUID, action: str, kind: str = "results", what: object = None) -> Result:
    """A result on visible patients, and an audit line for each of them."""
    query = select(Result).where(Result.id == result_id, visible_job(call, Result.job_id))
    found = call.db.scalars(query).one_or_none()
    if found is None:
        raise Absent("result", result_id)
    _audit_each(call, found.job_id, action, (kind, what or result_id))
    return found


def _audit_each(call: Call, job_id: UUID, action: str, what: tuple[str, object]) -> None:
    patients = patients_of(call, job_id)
    for patient_id in patients:
        require_write(call, patient_id, action)
        call.audit(action, what[0], what[1], patient_id)
    if not patients:
        call.audit(action, *what)


def patient_of(call: Call, session_id: UUID) -> UUID:
    """The patient of a visit that was found to be visible."""
    return call.db.get_one(GaitSession, session_id).patient_id
