"""All tables, in one place."""

from .accounts import ApiToken, IdempotencyKey, LoginAttempt, OneTimePurpose, OneTimeToken, Role, User, WebSession
from .clinical_rows import (
    Access,
    Attachment,
    Cohort,
    CohortMember,
    GaitSession,
    Patient,
    PatientIdentity,
    PatientShare,
    Recording,
    RecordingKind,
    RetentionRule,
    StoredFile,
    Subject,
    TreatmentStage,
    Upload,
    UploadChunk,
    UploadState,
)
from .schema import Row
from .work import (
    FINAL,
    AuditEntry,
    Job,
    JobKind,
    JobPatient,
    JobStatus,
    ReportSignature,
    ReportVersion,
    Result,
    ResultFile,
)

__all__ = [
    "FINAL", "Access", "ApiToken", "Attachment", "AuditEntry", "Cohort", "CohortMember", "GaitSession",
    "IdempotencyKey", "Job", "JobKind", "JobPatient", "JobStatus", "LoginAttempt", "OneTimePurpose", "OneTimeToken",
    "Patient", "PatientIdentity", "PatientShare", "Recording", "RecordingKind", "ReportSignature", "ReportVersion",
    "Result", "ResultFile", "RetentionRule", "Role", "Row", "StoredFile", "Subject", "TreatmentStage", "Upload",
    "UploadChunk", "UploadState", "User", "WebSession",
]  # fmt: skip
