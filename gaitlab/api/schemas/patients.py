"""Patients, their identity, sharing, visits, recordings, body models, attached files, uploads."""

from collections.abc import Mapping, Sequence
from datetime import date, datetime
from typing import Annotated, Any, Literal
from uuid import UUID

from pydantic import AfterValidator, ConfigDict, Field

from ...clinical.examination import check_examination
from ...errors import InvalidSubject
from ...pipelines.body_parameters import PLAUSIBLE
from ...storage.models import Access, RecordingKind, TreatmentStage, UploadState
from .forms import Edited, FileName, Input, Line, Output, Paging, Prose, Sha256, Stored, Word

Sex = Literal["", "female", "male", "other"]
_DAY = date(2026, 11, 20)


class NewPatient(Input):
    """A patient under a pseudonym."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"pseudonym": "P-0042", "sex": "female"}]})
    pseudonym: Word = Field(description="No name: researchers see it.")
    sex: Sex = ""
    diagnosis: Line = ""
    notes: Prose = ""
    retain_until: date | None = Field(default=None, description="Day after which retention removes the patient.")


class PatientChange(Input):
    """What is given is changed."""

    pseudonym: Word | None = None
    sex: Sex | None = None
    diagnosis: Line | None = None
    notes: Prose | None = None
    retain_until: date | None = None


class Patient(Edited):
    """A patient under a pseudonym; names are in the identity."""

    pseudonym: str = Field(examples=["P-0042"])
    sex: str
    diagnosis: str
    notes: str | None = Field(description="Free text may hold names: null for those who see pseudonyms only.")
    retain_until: date | None
    n_sessions: int = Field(examples=[2])
    last_visit: date | None
    access: Access = Field(description="What the asker may do with this patient.")


class PatientFilter(Paging):
    """Which patients."""

    search: Line = Field(
        default="", description="Part of pseudonym or diagnosis; of the name, too, for those who see names."
    )
    order: Literal["pseudonym", "-pseudonym", "created_at", "-created_at", "last_visit", "-last_visit"] = "pseudonym"


class IdentityChange(Input):
    """Who the patient is; replaces what is stored."""

    name: Line = ""
    birth_date: Annotated[date | None, Field(examples=[date(2017, 3, 2)])] = None
    record_number: Line = ""


class Identity(Output):
    """Who the patient is."""

    patient_id: UUID
    version: int
    name: str
    birth_date: date | None
    record_number: str


class ShareChange(Input):
    """What a colleague may do."""

    access: Access


class Share(Output):
    """A colleague's right to a patient."""

    user_id: UUID
    login: str
    display_name: str
    access: Access
    created_at: datetime


def _checked(value: Mapping[str, Any]) -> Mapping[str, Any]:
    try:
        return check_examination(value)
    except InvalidSubject as error:
        raise ValueError(str(error)) from error


Examination = Annotated[
    Mapping[str, Any],
    AfterValidator(_checked),
    Field(
        description="Clinical examination; GET /api/v1/schemas/examination describes it.",
        examples=[
            {
                "condition": {"footwear": "barefoot"},
                "ranges": [{"joint": "hip", "motion": "extension", "left": -5, "right": 0}],
                "spasticity": [{"muscle": "rectus femoris", "left": "1+", "right": "1"}],
            }
        ],
    ),
]


class NewSession(Input):
    """A visit to the laboratory."""

    visited_on: date = Field(examples=[_DAY])
    label: Line = ""
    condition: Line = Field(default="", examples=["barefoot"])
    treatment: Line = Field(default="", examples=["botulinum toxin, gastrocnemius"])
    stage: TreatmentStage = TreatmentStage.NONE
    age_years: float | None = Field(
        default=None, ge=0, le=130, description="At the visit; left away: from the birth date."
    )
    examination: Examination = Field(default_factory=dict)
    notes: Prose = ""


class SessionChange(Input):
    """What is given is changed."""

    visited_on: date | None = None
    label: Line | None = None
    condition: Line | None = None
    treatment: Line | None = None
    stage: TreatmentStage | None = None
    age_years: float | None = Field(default=None, ge=0, le=130)
    examination: Examination | None = None
    notes: Prose | None = None


class Session(Edited):
    """A visit to the laboratory."""

    patient_id: UUID
    visited_on: date
    label: str
    condition: str
    treatment: str
    stage: TreatmentStage
    age_years: float | None
    examination: Mapping[str, Any]
    notes: str | None = Field(description="Free text may hold names: null for those who see pseudonyms only.")


class SessionFilter(Paging):
    """Which visits."""

    patient_id: UUID | None = None


class Recording(Edited):
    """A C3D file of a visit."""

    session_id: UUID
    name: str = Field(description="File name; replaced by a number for those who see pseudonyms only.")
    kind: RecordingKind
    sha256: str
    size: int
    inspection: Mapping[str, Any] | None = Field(description="What the job 'inspect' found; null before it ended.")
    personal_entries: Sequence[str] = Field(description="Places of the header that may hold a name or a birth date.")


class RecordingChange(Input):
    """What is given is changed."""

    name: FileName | None = None
    kind: RecordingKind | None = None


class StrippedRecording(Output):
    """The recording with its new content, and what was blanked in it."""

    recording: Recording
    blanked: Sequence[str]


def _known(parameters: Mapping[str, float]) -> Mapping[str, float]:
    for name, value in parameters.items():
        if name not in PLAUSIBLE:
            raise ValueError(f"body parameter '{name}' does not exist; available: {', '.join(sorted(PLAUSIBLE))}")
        low, high, unit = PLAUSIBLE[name]
        if not low <= value <= high:
            raise ValueError(f"{name} is {value:g}: give a value from {low:.4g} to {high:.4g} {unit}")
    return parameters


BodyParameters = Annotated[
    Mapping[str, float],
    AfterValidator(_known),
    Field(examples=[{"mass": 31.5, "left_leg_length": 0.71}], description="SI units."),
]


class NewSubject(Input):
    """Body measurements of a visit."""

    name: Line = ""
    parameters: BodyParameters = Field(default_factory=dict)


class SubjectChange(Input):
    """What is given is changed."""

    name: Line | None = None
    parameters: BodyParameters | None = None


class Subject(Edited):
    """Body measurements of a visit, and whether a model was made of them."""

    session_id: UUID
    name: str
    parameters: Mapping[str, float]
    has_model: bool = Field(description="Whether an analysis has made a multibody model (URDF) of it.")


class Attachment(Stored):
    """A video or document of a visit."""

    session_id: UUID
    name: str
    media_type: str
    sha256: str
    size: int


MediaType = Annotated[str, Field(max_length=100, pattern=r"^[a-z0-9][a-z0-9.+-]*/[a-z0-9][a-z0-9.+-]*$")]


class NewUpload(Input):
    """A file that will arrive in chunks."""

    session_id: UUID
    name: FileName
    size: int = Field(ge=1, le=10**13, description="Bytes.")
    media_type: MediaType = Field(
        default="application/octet-stream",
        description="video/... makes an attachment; a name that ends in .c3d a recording.",
    )
    sha256: Sha256 | None = Field(default=None, description="Checked at the end, if given.")


class Upload(Stored):
    """A file that arrives in chunks."""

    session_id: UUID
    name: str
    media_type: str
    size: int
    received: int = Field(description="Bytes that are safe; the next chunk begins here.")
    state: UploadState
    expires_at: datetime
    recording_id: UUID | None
    attachment_id: UUID | None
    chunk_size: int = Field(description="Largest chunk [bytes].")
