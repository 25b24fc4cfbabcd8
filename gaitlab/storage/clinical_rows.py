"""Whose data: patients, visits, recordings, body models, attached files."""

from datetime import date, datetime
from enum import StrEnum
from uuid import UUID

from sqlalchemy import ForeignKey, Index, func
from sqlalchemy.orm import Mapped, mapped_column

from .schema import Bytes, Digest, Identified, Json, Row, Versioned, enum_column, now


class Access(StrEnum):
    """What a patient is shared for."""

    READ = "read"
    WRITE = "write"


class RecordingKind(StrEnum):
    """What a trial shows."""

    STATIC = "static"
    WALK = "walk"
    OTHER = "other"


class TreatmentStage(StrEnum):
    """When a visit took place, seen from a treatment."""

    BEFORE = "before"
    AFTER = "after"
    NONE = "none"


class UploadState(StrEnum):
    """How far an upload has come."""

    OPEN = "open"
    FINISHED = "finished"
    ABANDONED = "abandoned"


class StoredFile(Row):
    """A content in the file store; a row stands only after its bytes are safe on disk."""

    __tablename__ = "stored_files"

    sha256: Mapped[Digest] = mapped_column(primary_key=True)
    size: Mapped[Bytes]
    created_at: Mapped[datetime] = mapped_column(server_default=func.now(), default_factory=now)


class Patient(Identified, Versioned, Row):
    """A person under a pseudonym."""

    __tablename__ = "patients"

    pseudonym: Mapped[str] = mapped_column(unique=True)
    sex: Mapped[str] = mapped_column(default="")
    diagnosis: Mapped[str] = mapped_column(default="")
    notes: Mapped[str] = mapped_column(default="")
    created_by: Mapped[UUID | None] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), default=None)
    retain_until: Mapped[date | None] = mapped_column(default=None, index=True)
    """Day after which retention removes the patient; None: the general rule."""


class PatientIdentity(Versioned, Row):
    """Who the patient is; kept apart so that researchers' queries never touch it."""

    __tablename__ = "patient_identities"

    patient_id: Mapped[UUID] = mapped_column(ForeignKey("patients.id", ondelete="RESTRICT"), primary_key=True)
    name: Mapped[str] = mapped_column(default="")
    birth_date: Mapped[date | None] = mapped_column(default=None)
    record_number: Mapped[str] = mapped_column(default="")
    """The hospital's number."""


class PatientShare(Row):
    """A user's right to one patient."""

    __tablename__ = "patient_shares"

    patient_id: Mapped[UUID] = mapped_column(ForeignKey("patients.id", ondelete="RESTRICT"), primary_key=True)
    user_id: Mapped[UUID] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), primary_key=True, index=True)
    access: Mapped[Access] = mapped_column(enum_column(Access))
    created_by: Mapped[UUID | None] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), default=None)
    created_at: Mapped[datetime] = mapped_column(default_factory=now)


class GaitSession(Identified, Versioned, Row):
    """A visit to the laboratory."""

    __tablename__ = "sessions"

    patient_id: Mapped[UUID] = mapped_column(ForeignKey("patients.id", ondelete="RESTRICT"), index=True)
    visited_on: Mapped[date]
    label: Mapped[str] = mapped_column(default="")
    condition: Mapped[str] = mapped_column(default="")
    """Barefoot, orthosis, walking aid ..."""
    treatment: Mapped[str] = mapped_column(default="")
    stage: Mapped[TreatmentStage] = mapped_column(enum_column(TreatmentStage), default=TreatmentStage.NONE)
    age_years: Mapped[float | None] = mapped_column(default=None)
    """Age at the visit, kept here so that norms need no birth date [years]."""
    examination: Mapped[Json] = mapped_column(default_factory=dict)
    """Clinical examination: ranges of motion, strength, spasticity."""
    notes: Mapped[str] = mapped_column(default="")


class Attachment(Identified, Row):
    """A video or document of a visit."""

    __tablename__ = "attachments"

    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="RESTRICT"), index=True)
    name: Mapped[str]
    media_type: Mapped[str]
    sha256: Mapped[Digest] = mapped_column(ForeignKey("stored_files.sha256", ondelete="RESTRICT"), index=True)
    size: Mapped[Bytes]
    created_by: Mapped[UUID | None] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), default=None)


class Recording(Identified, Versioned, Row):
    """A C3D file of a visit."""

    __tablename__ = "recordings"

    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="RESTRICT"), index=True)
    name: Mapped[str]
    """File name without folders."""
    sha256: Mapped[Digest] = mapped_column(ForeignKey("stored_files.sha256", ondelete="RESTRICT"), index=True)
    size: Mapped[Bytes]
    kind: Mapped[RecordingKind] = mapped_column(enum_column(RecordingKind), default=RecordingKind.OTHER)
    inspection: Mapped[Json | None] = mapped_column(default=None)
    """What the job `inspect` found; None before it."""
    personal_entries: Mapped[list[str]] = mapped_column(default_factory=list)
    """Entries of the header that hold a name or a birth date."""
    created_by: Mapped[UUID | None] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), default=None)


class Subject(Identified, Versioned, Row):
    """Body measurements of a patient at a visit, and the multibody model made of them."""

    __tablename__ = "subjects"

    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="RESTRICT"), index=True)
    name: Mapped[str] = mapped_column(default="")
    parameters: Mapped[Json] = mapped_column(default_factory=dict)
    """Body parameters in SI units, as `AnalysisOptions.parameters`."""
    model_sha256: Mapped[Digest | None] = mapped_column(
        ForeignKey("stored_files.sha256", ondelete="RESTRICT"), default=None, index=True
    )
    """The model as URDF, once an analysis has made it."""


class Upload(Identified, Row):
    """A file that arrives in chunks."""

    __tablename__ = "uploads"

    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="RESTRICT"), index=True)
    user_id: Mapped[UUID] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), index=True)
    name: Mapped[str]
    size: Mapped[Bytes]
    """As announced."""
    expires_at: Mapped[datetime] = mapped_column(index=True)
    media_type: Mapped[str] = mapped_column(default="application/octet-stream")
    sha256: Mapped[Digest | None] = mapped_column(default=None)
    """As announced, if at all."""
    state: Mapped[UploadState] = mapped_column(enum_column(UploadState), default=UploadState.OPEN)
    recording_id: Mapped[UUID | None] = mapped_column(ForeignKey("recordings.id", ondelete="RESTRICT"), default=None)
    attachment_id: Mapped[UUID | None] = mapped_column(ForeignKey("attachments.id", ondelete="RESTRICT"), default=None)


class UploadChunk(Row):
    """A part of an upload, kept in the file store, so that any web process can take the next one."""

    __tablename__ = "upload_chunks"

    upload_id: Mapped[UUID] = mapped_column(ForeignKey("uploads.id", ondelete="RESTRICT"), primary_key=True)
    offset: Mapped[Bytes] = mapped_column(primary_key=True)
    size: Mapped[Bytes]
    sha256: Mapped[Digest] = mapped_column(ForeignKey("stored_files.sha256", ondelete="RESTRICT"), index=True)


class RetentionRule(Row):
    """How long something is kept."""

    __tablename__ = "retention_rules"

    subject: Mapped[str] = mapped_column(primary_key=True)
    """One of `storage.retention.SUBJECTS`."""
    days: Mapped[int]


class Cohort(Identified, Versioned, Row):
    """A named set of results, for norms and comparisons."""

    __tablename__ = "cohorts"

    name: Mapped[str] = mapped_column(unique=True)
    description: Mapped[str] = mapped_column(default="")
    created_by: Mapped[UUID | None] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), default=None)


class CohortMember(Row):
    """A result in a cohort."""

    __tablename__ = "cohort_members"
    __table_args__ = (Index("ix_cohort_members_result_id", "result_id"),)

    cohort_id: Mapped[UUID] = mapped_column(ForeignKey("cohorts.id", ondelete="RESTRICT"), primary_key=True)
    result_id: Mapped[UUID] = mapped_column(ForeignKey("results.id", ondelete="RESTRICT"), primary_key=True)
    group: Mapped[str] = mapped_column(default="")
