"""What was computed: jobs, results, reports, and the log of who did what."""

from datetime import datetime
from enum import StrEnum
from uuid import UUID

from sqlalchemy import BigInteger, ForeignKey, Index, UniqueConstraint, text
from sqlalchemy.orm import Mapped, mapped_column

from .schema import Bytes, Digest, Identified, Json, Row, Versioned, enum_column, now


class JobKind(StrEnum):
    """What a job computes; `jobs.tasks` holds the task of each."""

    INSPECT = "inspect"
    ANALYSE = "analyse"
    PREDICT = "predict"
    REPORT = "report"
    COMPARE = "compare"
    NORMS = "norms"


class JobStatus(StrEnum):
    """Where a job stands. The last three are final."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


FINAL = frozenset({JobStatus.SUCCEEDED, JobStatus.FAILED, JobStatus.CANCELLED})


class Job(Identified, Row):
    """One computation that was asked for."""

    __tablename__ = "jobs"
    __table_args__ = (
        Index("ix_jobs_status_created_at", "status", "created_at"),
        # The same input is computed once: a second request finds the first, unless that failed or was cancelled.
        Index(
            "uq_jobs_input_hash",
            "kind",
            "input_hash",
            unique=True,
            postgresql_where=text("status IN ('queued', 'running', 'succeeded')"),
        ),
    )

    kind: Mapped[JobKind] = mapped_column(enum_column(JobKind))
    input_hash: Mapped[Digest]
    """SHA-256 of kind, inputs and settings."""
    session_id: Mapped[UUID | None] = mapped_column(
        ForeignKey("sessions.id", ondelete="RESTRICT"), default=None, index=True
    )
    """The visit it belongs to; None for jobs over several visits."""
    created_by: Mapped[UUID | None] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), default=None)
    inputs: Mapped[list[Json]] = mapped_column(default_factory=list)
    """Files read: role, name, sha256, recording or result id."""
    settings: Mapped[Json] = mapped_column(default_factory=dict)
    status: Mapped[JobStatus] = mapped_column(enum_column(JobStatus), default=JobStatus.QUEUED)
    priority: Mapped[int] = mapped_column(default=0)
    """Higher first."""
    attempt: Mapped[int] = mapped_column(default=0)
    """Fencing number: grows with every start; only the newest attempt may write."""
    losses: Mapped[int] = mapped_column(default=0)
    """How often its process or its worker died."""
    heartbeat_at: Mapped[datetime | None] = mapped_column(default=None)
    """Last sign of life of the running attempt."""
    queue_job_id: Mapped[int | None] = mapped_column(BigInteger, default=None, index=True)
    """Its row in procrastinate's queue."""
    worker: Mapped[str] = mapped_column(default="")
    cancel_requested: Mapped[bool] = mapped_column(default=False)
    progress: Mapped[Json] = mapped_column(default_factory=dict)
    """Last progress report: stage, trial, done, iteration, residual, seconds."""
    started_at: Mapped[datetime | None] = mapped_column(default=None)
    finished_at: Mapped[datetime | None] = mapped_column(default=None)
    error: Mapped[str] = mapped_column(default="")
    """The sentence of the command line, if it failed."""
    failure: Mapped[Json | None] = mapped_column(default=None)
    """How it failed: kind, signal, exit code, end of stderr."""
    request_id: Mapped[str] = mapped_column(default="")


class JobPatient(Row):
    """A patient whose data a job reads; deleting the patient deletes the job and its result."""

    __tablename__ = "job_patients"

    job_id: Mapped[UUID] = mapped_column(ForeignKey("jobs.id", ondelete="RESTRICT"), primary_key=True)
    patient_id: Mapped[UUID] = mapped_column(
        ForeignKey("patients.id", ondelete="RESTRICT"), primary_key=True, index=True
    )


class Result(Identified, Row):
    """What a job produced. Written once, by the newest attempt, in the transaction that ends the job."""

    __tablename__ = "results"

    job_id: Mapped[UUID] = mapped_column(ForeignKey("jobs.id", ondelete="RESTRICT"), unique=True)
    kind: Mapped[JobKind] = mapped_column(enum_column(JobKind))
    attempt: Mapped[int]
    provenance: Mapped[Json]
    """Versions, input hashes, settings, seed, machine, seconds."""
    session_id: Mapped[UUID | None] = mapped_column(
        ForeignKey("sessions.id", ondelete="RESTRICT"), default=None, index=True
    )
    converged: Mapped[bool] = mapped_column(default=True)
    message: Mapped[str] = mapped_column(default="")
    """What did not converge, in words."""
    summary: Mapped[Json] = mapped_column(default_factory=dict)
    """A few numbers for lists; everything is in the files."""


class ResultFile(Row):
    """A file of a result."""

    __tablename__ = "result_files"

    result_id: Mapped[UUID] = mapped_column(ForeignKey("results.id", ondelete="RESTRICT"), primary_key=True)
    name: Mapped[str] = mapped_column(primary_key=True)
    """Path inside the result's folder, with /."""
    media_type: Mapped[str]
    sha256: Mapped[Digest] = mapped_column(ForeignKey("stored_files.sha256", ondelete="RESTRICT"), index=True)
    size: Mapped[Bytes]


class ReportVersion(Identified, Versioned, Row):
    """A version of the report of a visit. Once signed it is never changed; a correction is a new version."""

    __tablename__ = "report_versions"
    __table_args__ = (UniqueConstraint("session_id", "number", name="uq_report_versions_session_id_number"),)

    session_id: Mapped[UUID] = mapped_column(ForeignKey("sessions.id", ondelete="RESTRICT"))
    number: Mapped[int]
    result_id: Mapped[UUID | None] = mapped_column(
        ForeignKey("results.id", ondelete="RESTRICT"), default=None, index=True
    )
    """The analysis it reports on."""
    content: Mapped[Json] = mapped_column(default_factory=dict)
    """What clinicians wrote, and the choices of the document."""
    html_sha256: Mapped[Digest | None] = mapped_column(
        ForeignKey("stored_files.sha256", ondelete="RESTRICT"), default=None, index=True
    )
    pdf_sha256: Mapped[Digest | None] = mapped_column(
        ForeignKey("stored_files.sha256", ondelete="RESTRICT"), default=None, index=True
    )
    created_by: Mapped[UUID | None] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), default=None)


class ReportSignature(Identified, Row):
    """A user's signature under a report."""

    __tablename__ = "report_signatures"
    __table_args__ = (UniqueConstraint("report_id", "user_id", name="uq_report_signatures_report_id_user_id"),)

    report_id: Mapped[UUID] = mapped_column(ForeignKey("report_versions.id", ondelete="RESTRICT"))
    user_id: Mapped[UUID] = mapped_column(ForeignKey("users.id", ondelete="RESTRICT"), index=True)
    document_sha256: Mapped[Digest]
    """Of what was signed: the PDF, or the content where there is none."""
    meaning: Mapped[str] = mapped_column(default="author")


class AuditEntry(Row):
    """Who did what to which data. The database refuses to change or delete a line; no column refers to other rows."""

    __tablename__ = "audit_log"
    __table_args__ = (Index("ix_audit_log_patient_id_at", "patient_id", "at"),)

    id: Mapped[int] = mapped_column(BigInteger, primary_key=True, init=False)
    action: Mapped[str]
    """read, create, update, delete, export, sign, login, logout, denied ..."""
    kind: Mapped[str]
    """Table or route: patients, sessions, results, ..."""
    at: Mapped[datetime] = mapped_column(default_factory=now, index=True)
    user_id: Mapped[UUID | None] = mapped_column(default=None, index=True)
    login: Mapped[str] = mapped_column(default="")
    object_id: Mapped[str] = mapped_column(default="")
    patient_id: Mapped[UUID | None] = mapped_column(default=None)
    request_id: Mapped[str] = mapped_column(default="")
    address: Mapped[str] = mapped_column(default="")
    detail: Mapped[Json] = mapped_column(default_factory=dict)
    """Without names."""
