"""What an installation can do and is doing, and its audit log."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any
from uuid import UUID

from pydantic import Field

from ...storage.models import JobStatus
from .forms import Input, Line, Output, Paging


class SystemState(Output):
    """What the service is doing."""

    version: str
    jobs: Mapping[JobStatus, int]
    workers: Sequence[Mapping[str, Any]]
    viewers: int
    rows: Mapping[str, int] = Field(description="Number of rows by table.")
    database_bytes: int
    files: int
    file_bytes: int


class RetentionRule(Output):
    """How long something is kept."""

    subject: str = Field(examples=["patients"])
    days: int | None = Field(description="Null: for ever. Patients count from their last visit.", examples=[3650])


class RetentionChange(Input):
    """How long something is to be kept."""

    days: int | None = Field(ge=1, le=100_000, description="Null: the default again.", examples=[3650])


class PredictionQuantity(Output):
    """Something that a prediction may change."""

    unit: str = Field(examples=["N*m"])
    lowest: float
    highest: float
    relative_to: str = Field(description="What a change in per cent refers to; empty where only a number is taken.")


class About(Output):
    """What this installation can do."""

    version: str
    criteria: Sequence[str]
    default_criteria: Sequence[str]
    curves: Sequence[str]
    body_parameters: Mapping[str, Sequence[float | str]] = Field(
        description="Lowest plausible value, highest, unit.", examples=[{"mass": [1.0, 500.0, "kg"]}]
    )
    prediction_quantities: Mapping[str, PredictionQuantity] = Field(description="What `changes` may name.")
    norms: Sequence[str]
    largest_recording: int
    largest_upload: int
    chunk_size: int


class AuditLine(Output):
    """Who did what to which data."""

    id: int
    at: datetime
    user_id: UUID | None
    login: str
    action: str
    kind: str
    object_id: str
    patient_id: UUID | None
    request_id: str
    address: str
    detail: Mapping[str, Any]


class AuditFilter(Paging):
    """Which lines."""

    user_id: UUID | None = None
    patient_id: UUID | None = None
    action: Line = ""
    kind: Line = ""
    after: datetime | None = None
    before: datetime | None = None
