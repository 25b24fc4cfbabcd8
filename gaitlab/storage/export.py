"""Everything about one patient as a zip: the right of access, and the way to another installation."""

import zipfile
from collections.abc import Iterator, Sequence
from datetime import date, datetime
from typing import Any, BinaryIO
from uuid import UUID

import msgspec
from sqlalchemy import select
from sqlalchemy.orm import Session

from ..errors import NotFound
from .database import Database
from .files import FileStore
from .models import (
    Attachment,
    AuditEntry,
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
    Row,
    Subject,
)


def export_patient(database: Database, store: FileStore, patient_id: UUID, target: BinaryIO) -> None:
    """Write the zip: `patient.json` with all rows, and every file under a telling path.

    Raises:
        NotFound: There is no such patient.
        StorageError: A file is missing or damaged.
    """
    with database.sessions() as session:
        if session.get(Patient, patient_id) is None:
            raise NotFound("patient", str(patient_id), ())
        rows = _rows(session, patient_id)
        files = list(_files(rows))
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        text = {name: [_plain(row) for row in part] for name, part in rows.items()}
        archive.writestr("patient.json", msgspec.json.format(msgspec.json.encode(text), indent=1))
        for path, digest in files:
            with archive.open(path, "w", force_zip64=True) as file:
                for piece in store.open(digest):
                    file.write(piece)


def _rows(session: Session, patient_id: UUID) -> dict[str, Sequence[Row]]:
    sessions = select(GaitSession.id).where(GaitSession.patient_id == patient_id)
    own = select(JobPatient.job_id).where(JobPatient.patient_id == patient_id)
    shared = select(JobPatient.job_id).where(JobPatient.patient_id != patient_id)
    # Comparisons and norms of several people hold data of others.
    jobs = select(Job.id).where(Job.session_id.in_(sessions) | Job.id.in_(own), Job.id.not_in(shared))
    results = select(Result.id).where(Result.job_id.in_(jobs))
    reports = select(ReportVersion.id).where(ReportVersion.session_id.in_(sessions))
    statements = {
        "patients": select(Patient).where(Patient.id == patient_id),
        "patient_identities": select(PatientIdentity).where(PatientIdentity.patient_id == patient_id),
        "patient_shares": select(PatientShare).where(PatientShare.patient_id == patient_id),
        "sessions": select(GaitSession).where(GaitSession.patient_id == patient_id),
        "recordings": select(Recording).where(Recording.session_id.in_(sessions)),
        "attachments": select(Attachment).where(Attachment.session_id.in_(sessions)),
        "subjects": select(Subject).where(Subject.session_id.in_(sessions)),
        "jobs": select(Job).where(Job.id.in_(jobs)),
        "results": select(Result).where(Result.job_id.in_(jobs)),
        "result_files": select(ResultFile).where(ResultFile.result_id.in_(results)),
        "report_versions": select(ReportVersion).where(ReportVersion.session_id.in_(sessions)),
        "report_signatures": select(ReportSignature).where(ReportSignature.report_id.in_(reports)),
        "audit_log": select(AuditEntry).where(AuditEntry.patient_id == patient_id).order_by(AuditEntry.id),
    }
    return {name: session.scalars(statement).all() for name, statement in statements.items()}


def _files(rows: dict[str, Sequence[Row]]) -> Iterator[tuple[str, str]]:
    """Path in the zip and content of every file."""
    visits = {row.id: f"{row.visited_on}-{row.id.hex[:8]}" for row in rows["sessions"] if isinstance(row, GaitSession)}
    named = [(row, _path(row)) for part in rows.values() for row in part]
    for row, path in named:
        session_id: UUID | None = getattr(row, "session_id", None)
        folder = f"sessions/{visits[session_id]}" if session_id is not None and session_id in visits else ""
        for column in ("sha256", "model_sha256", "html_sha256", "pdf_sha256"):
            digest = getattr(row, column, None)
            if path and digest:
                yield f"{folder}/{path}{ENDINGS.get(column, '')}".lstrip("/"), digest


ENDINGS = {"html_sha256": ".html", "pdf_sha256": ".pdf"}


def _path(row: Row) -> str:
    match row:
        case Recording() | Attachment():
            return f"{row.__tablename__}/{row.id.hex[:8]}-{row.name}"
        case ResultFile():
            return f"results/{row.result_id}/{row.name}"
        case Subject():
            return f"subjects/{row.id.hex[:8]}.urdf"
        case ReportVersion():
            return f"reports/{row.number}"
        case _:
            return ""


def _plain(row: Row) -> dict[str, Any]:
    return {column.key: _value(getattr(row, column.key)) for column in row.__mapper__.column_attrs}


def _value(value: object) -> object:
    if isinstance(value, UUID):
        return str(value)
    return value.isoformat() if isinstance(value, date | datetime) else value
