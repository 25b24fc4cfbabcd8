"""Deleting: rows in the order of their references, then the contents that nobody uses any more."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy import CompoundSelect, Select, delete, select, text, union
from sqlalchemy.orm import Session

from ..errors import NotFound
from .audit import Actor, Deed, record
from .database import Database
from .files import FileStore
from .models import (
    Attachment,
    CohortMember,
    GaitSession,
    Job,
    JobPatient,
    Patient,
    PatientIdentity,
    PatientShare,
    Recording,
    ReportSignature,
    ReportVersion,
    Result,
    ResultFile,
    Subject,
    Upload,
    UploadChunk,
)
from .references import remove_unused

READS = text("EXISTS (SELECT 1 FROM jsonb_array_elements(jobs.inputs) AS part WHERE part->>'source' = ANY(:sources))")
"""Whether a job's inputs hold one of these recordings or results."""


@dataclass(frozen=True, kw_only=True)
class Deleted:
    """What went with a patient or a visit."""

    sessions: int
    recordings: int
    jobs: int
    digests: tuple[str, ...]
    """Contents that were referred to; others may still use some of them."""


@dataclass(frozen=True, kw_only=True)
class _Doomed:
    """Visits and jobs that are deleted, and what hangs on them: the same rows for their contents and for themselves."""

    sessions: tuple[UUID, ...]
    jobs: tuple[UUID, ...]

    @property
    def uploads(self) -> Select[UUID]:
        return select(Upload.id).where(Upload.session_id.in_(self.sessions))

    @property
    def results(self) -> Select[UUID]:
        return select(Result.id).where(Result.job_id.in_(self.jobs))

    @property
    def reports(self) -> Select[UUID]:
        """Those of other visits on one of the results included."""
        return select(ReportVersion.id).where(
            ReportVersion.session_id.in_(self.sessions) | ReportVersion.result_id.in_(self.results)
        )


def delete_patient(database: Database, store: FileStore, patient_id: UUID, actor: Actor) -> Deleted:
    """Delete a patient with everything computed from their data, comparisons and norms of several people included.

    A computation that runs ends by itself: its job's row is gone. One line of the audit log stays.

    Raises:
        NotFound: There is no such patient.
    """
    with database.transaction() as session:
        if session.get(Patient, patient_id, with_for_update=True) is None:
            raise NotFound("patient", str(patient_id), ())
        sessions = list(session.scalars(select(GaitSession.id).where(GaitSession.patient_id == patient_id)))
        jobs = session.scalars(select(JobPatient.job_id).where(JobPatient.patient_id == patient_id))
        deleted = _delete_sessions(session, sessions, jobs)
        for statement in (
            delete(PatientShare).where(PatientShare.patient_id == patient_id),
            delete(PatientIdentity).where(PatientIdentity.patient_id == patient_id),
            delete(Patient).where(Patient.id == patient_id),
        ):
            session.execute(statement)
        record(session, actor, _deed("patients", str(patient_id), patient_id, deleted))
    remove_unused(database, store, deleted.digests)
    return deleted


def delete_session(database: Database, store: FileStore, session_id: UUID, actor: Actor) -> Deleted:
    """Delete a visit with everything computed from it.

    Raises:
        NotFound: There is no such visit.
    """
    with database.transaction() as session:
        visit = session.get(GaitSession, session_id, with_for_update=True)
        if visit is None:
            raise NotFound("session", str(session_id), ())
        deleted = _delete_sessions(session, [session_id], _jobs_that_read(session, visit))
        record(session, actor, _deed("sessions", str(session_id), visit.patient_id, deleted))
    remove_unused(database, store, deleted.digests)
    return deleted


def _deed(kind: str, object_id: str, patient_id: UUID, deleted: Deleted) -> Deed:
    detail = {"sessions": deleted.sessions, "recordings": deleted.recordings, "jobs": deleted.jobs}
    return Deed(action="delete", kind=kind, object_id=object_id, patient_id=patient_id, detail=detail)


def _delete_sessions(session: Session, sessions: Sequence[UUID], more_jobs: Iterable[UUID]) -> Deleted:
    recordings = list(session.scalars(select(Recording.id).where(Recording.session_id.in_(sessions))))
    jobs = {*more_jobs, *session.scalars(select(Job.id).where(Job.session_id.in_(sessions)))}
    doomed = _Doomed(sessions=tuple(sessions), jobs=tuple(jobs))
    digests = tuple(row[0] for row in session.execute(_contents(doomed)))
    for statement in (
        delete(ReportSignature).where(ReportSignature.report_id.in_(doomed.reports)),
        delete(ReportVersion).where(ReportVersion.id.in_(doomed.reports)),
        delete(CohortMember).where(CohortMember.result_id.in_(doomed.results)),
        delete(ResultFile).where(ResultFile.result_id.in_(doomed.results)),
        delete(Result).where(Result.id.in_(doomed.results)),
        delete(JobPatient).where(JobPatient.job_id.in_(jobs)),
        delete(Job).where(Job.id.in_(jobs)),
        delete(UploadChunk).where(UploadChunk.upload_id.in_(doomed.uploads)),
        delete(Upload).where(Upload.session_id.in_(sessions)),
        delete(Attachment).where(Attachment.session_id.in_(sessions)),
        delete(Subject).where(Subject.session_id.in_(sessions)),
        delete(Recording).where(Recording.session_id.in_(sessions)),
        delete(GaitSession).where(GaitSession.id.in_(sessions)),
    ):
        session.execute(statement.execution_options(synchronize_session=False))
    return Deleted(sessions=len(sessions), recordings=len(recordings), jobs=len(jobs), digests=digests)


def _jobs_that_read(session: Session, visit: GaitSession) -> set[UUID]:
    """Jobs on the same patient that read recordings or results of the visit, and those that read their results.

    An analysis of somebody else with norms that the visit went into is none of them: it stays.
    """
    own = select(JobPatient.job_id).where(JobPatient.patient_id == visit.patient_id)
    sources = {*session.scalars(select(Recording.id).where(Recording.session_id == visit.id))}
    sources |= {*session.scalars(select(Result.id).where(Result.session_id == visit.id))}
    found: set[UUID] = set()
    while sources:
        reads = READS.bindparams(sources=[str(each) for each in sources])
        fresh = {*session.scalars(select(Job.id).where(reads, Job.id.in_(own)))} - found
        found |= fresh
        sources = {*session.scalars(select(Result.id).where(Result.job_id.in_(fresh)))}
    return found


def _contents(doomed: _Doomed) -> CompoundSelect[Any]:
    """Contents that the rows refer to."""
    sessions = doomed.sessions
    reports = ReportVersion.id.in_(doomed.reports)
    return union(
        select(Recording.sha256).where(Recording.session_id.in_(sessions)),
        select(Attachment.sha256).where(Attachment.session_id.in_(sessions)),
        select(UploadChunk.sha256).where(UploadChunk.upload_id.in_(doomed.uploads)),
        select(Subject.model_sha256).where(Subject.session_id.in_(sessions), Subject.model_sha256.is_not(None)),
        select(ResultFile.sha256).where(ResultFile.result_id.in_(doomed.results)),
        select(ReportVersion.html_sha256).where(reports, ReportVersion.html_sha256.is_not(None)),
        select(ReportVersion.pdf_sha256).where(reports, ReportVersion.pdf_sha256.is_not(None)),
    )
