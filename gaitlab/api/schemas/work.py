"""Analyses (jobs), results, reports, comparisons, cohorts, and the state of the service."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Annotated, Any, Literal
from uuid import UUID

from pydantic import AfterValidator, Field, StringConstraints

from ...errors import NotFound
from ...storage.models import JobKind, JobStatus
from ..choices import (
    DEFAULT_CRITERIA,
    CriterionName,
    InertiaConvention,
    Landing,
    MomentFrame,
    Palette,
    ReportPage,
    StaticOffsets,
)
from ..quantities import check_change
from .forms import Edited, Input, Line, Output, Paging, Prose, Stored, Word
from .patients import BodyParameters


class CorrectedEvent(Input):
    """Foot strike or foot off of one side."""

    side: Literal["left", "right"]
    kind: Literal["foot_strike", "foot_off"]
    time_s: float = Field(ge=0, le=3600, description="From the first stored frame [s].")


class AnalysisSettings(Input):
    """Choices of an analysis, as the options of `gaitlab analyse`."""

    parameters: BodyParameters = Field(default_factory=dict)
    criteria: Sequence[CriterionName] = Field(default=DEFAULT_CRITERIA, min_length=1, max_length=6)
    weights: bool = Field(
        default=True, description="Compute the walk and its weights; without, only the clinical part."
    )
    seed: int = Field(default=0, ge=0, le=2**31 - 1)
    landing: Landing = "soft"
    trunk_joint: bool = False
    redetect_events: bool = False
    events: Mapping[Line, Annotated[Sequence[CorrectedEvent], Field(max_length=1000)]] = Field(
        default_factory=dict[str, Sequence[CorrectedEvent]],
        max_length=50,
        description="All events of a walk, by its file's name without ending, where somebody corrected them.",
    )
    static_offsets: StaticOffsets = "computed"
    longest_gap: float = Field(default=0.1, ge=0, le=10, description="Longest gap of a marker that is filled [s].")
    moment_frame: MomentFrame = "distal"
    kinetics_inertia: InertiaConvention = "subject"
    norms: Line = Field(
        default="schwartz2008", description="Name of bundled norms, id of a result of the job 'norms', or none."
    )
    match_speed: bool = False
    age: float | None = Field(default=None, ge=0, le=130, description="Years; left away: the visit's.")


class _NewJob(Input):
    priority: int = Field(default=0, ge=-10, le=10, description="Higher first.")


class NewInspection(_NewJob):
    """Look again at what is in a recording."""

    kind: Literal["inspect"]
    recording_id: UUID


class NewAnalysis(_NewJob):
    """Angles, events, model, walk and weights of a visit."""

    kind: Literal["analyse"]
    session_id: UUID
    walks: Sequence[UUID] = Field(default=(), max_length=50, description="Recordings; empty: all walks of the visit.")
    static: UUID | None = Field(default=None, description="Recording; null: the visit's static trial, if there is one.")
    subject_id: UUID | None = Field(default=None, description="Body measurements that replace those of the files.")
    settings: AnalysisSettings = Field(default_factory=AnalysisSettings)


def _known(change: str) -> str:
    try:
        return check_change(change)
    except NotFound as error:
        raise ValueError(str(error)) from error


Change = Annotated[
    str,
    StringConstraints(max_length=80, pattern=r"^[a-z_]+=[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?%?$"),
    AfterValidator(_known),
]


class NewPrediction(_NewJob):
    """The optimal walk of a changed body, or at another speed."""

    kind: Literal["predict"]
    result_id: UUID = Field(description="The analysis to start from.")
    trial: Line = Field(default="", description="Name of one walk; empty: the first.")
    changes: Sequence[Change] = Field(
        default=(),
        max_length=100,
        description="As `gaitlab predict --set`: name=value, or name=+10%; none: the identified gait itself. "
        "GET /api/v1/about lists the names under prediction_quantities.",
        examples=[["speed=+10%", "left_ankle_orthosis=1"]],
    )


class ReportContent(Input):
    """What stands in a report, and in which form."""

    pages: Sequence[ReportPage] = Field(default=(), max_length=20, description="Empty: all.")
    colours: Palette = "standard"
    notes: Sequence[Line] = Field(default=(), max_length=50, description="Printed with the examination.")


class NewReport(_NewJob):
    """The report of an analysis as PDF and HTML; a new version of it."""

    kind: Literal["report"]
    result_id: UUID
    content: ReportContent = Field(default_factory=ReportContent)


class ComparedResult(Input):
    """A result and the group it belongs to."""

    result_id: UUID
    group: Line = ""


class NewComparison(_NewJob):
    """Tables and figures of several results."""

    kind: Literal["compare"]
    members: Annotated[Sequence[ComparedResult], Field(min_length=1, max_length=2000)]
    baseline: UUID | None = Field(default=None, description="Result that differences are taken from; null: the first.")


class NewNorms(_NewJob):
    """A reference cohort of one's own."""

    kind: Literal["norms"]
    cohort_id: UUID
    name: Word
    source: Line = "own laboratory"
    licence: Line = "own data of the laboratory"
    ages: Annotated[Sequence[float], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="Youngest and oldest [years]."
    )
    speed_edges: Sequence[Annotated[float, Field(gt=0, le=10)]] = Field(default=(), max_length=20)


NewJob = Annotated[
    NewInspection | NewAnalysis | NewPrediction | NewReport | NewComparison | NewNorms, Field(discriminator="kind")
]


class Progress(Output):
    """The last report of a running job."""

    stage: str = ""
    trial: str = ""
    done: float | None = Field(default=None, description="Finished part of the stage, 0 to 1, where known.")
    iteration: int | None = None
    residual: float | None = None
    seconds: float | None = None


class JobInput(Output):
    """A file that a job reads."""

    role: str = ""
    name: str = ""
    sha256: str = ""
    source: str = Field(default="", description="The recording or the result that it comes from.")


class Job(Stored):
    """A computation that was asked for."""

    kind: JobKind
    status: JobStatus
    session_id: UUID | None
    created_by: UUID | None
    inputs: Sequence[JobInput]
    settings: Mapping[str, Any]
    priority: int
    attempt: int
    cancel_requested: bool
    progress: Progress
    started_at: datetime | None
    finished_at: datetime | None
    error: str = Field(description="Why it failed: the sentence of the command line.")
    failure: Mapping[str, Any] | None = Field(description="How its process ended: signal, exit code, end of stderr.")
    result_id: UUID | None = Field(description="What it produced.")


class JobFilter(Paging):
    """Which jobs."""

    patient_id: UUID | None = None
    session_id: UUID | None = None
    kind: JobKind | None = None
    status: JobStatus | None = None


class PriorityChange(Input):
    """A new place in the queue."""

    priority: int = Field(ge=-10, le=10)


class ResultFile(Output):
    """A file of a result."""

    name: str = Field(examples=["walk_1/walk.npz"])
    media_type: str
    sha256: str
    size: int


class Result(Stored):
    """What a job produced."""

    job_id: UUID
    kind: JobKind
    session_id: UUID | None
    patient_id: UUID | None
    converged: bool
    message: str = Field(description="What did not converge, in words.")
    summary: Mapping[str, Any] = Field(description="A few numbers for lists.")
    provenance: Mapping[str, Any] = Field(description="Versions, input hashes, settings, seed, machine, seconds.")


class ResultWithFiles(Result):
    """What a job produced, with its files."""

    files: Sequence[ResultFile]


class ResultFilter(Paging):
    """Which results."""

    patient_id: UUID | None = None
    session_id: UUID | None = None
    kind: JobKind | None = None


class Viewer(Output):
    """A running 3D session."""

    id: str
    result_id: UUID
    url: str = Field(examples=["/api/v1/viewers/6J1f.../"], description="To be shown in an iframe.")
    control: str = Field(description="Path of a WebSocket: both ways JSON, to move time and to hear of it.")
    trials: Sequence[str]


class Report(Edited):
    """A version of a report."""

    session_id: UUID
    number: int
    result_id: UUID | None
    content: Mapping[str, Any]
    has_pdf: bool
    has_html: bool
    signatures: Sequence["Signature"]


class Signature(Stored):
    """A user's signature under a report."""

    user_id: UUID
    display_name: str
    meaning: str
    document_sha256: str


class NewSignature(Input):
    """Sign a report; the password shows that it is the user and not an open screen."""

    password: Annotated[str, Field(max_length=256)] = Field(
        description="Left empty by accounts with single sign-on only."
    )
    meaning: Word = "author"


class ReportFilter(Paging):
    """Which reports."""

    session_id: UUID | None = None


class NewCohort(Input):
    """A named set of results."""

    name: Word
    description: Prose = ""
    members: Sequence[ComparedResult] = Field(default=(), max_length=5000)


class CohortChange(Input):
    """What is given is changed; members are replaced as a whole."""

    name: Word | None = None
    description: Prose | None = None
    members: Sequence[ComparedResult] | None = Field(default=None, max_length=5000)


class CohortMember(Output):
    """A result in a cohort."""

    result_id: UUID
    group: str


class Cohort(Edited):
    """A named set of results."""

    name: str
    description: str
    n_members: int
    created_by: UUID | None


class CohortWithMembers(Cohort):
    """A named set of results that the asker may see."""

    members: Sequence[CohortMember]


class ComparisonOrder(Input):
    """Results to put side by side at once."""

    members: Annotated[Sequence[ComparedResult], Field(min_length=1, max_length=2000)]
    baseline: UUID | None = Field(default=None, description="Result that differences are taken from; null: the first.")
    tables: Sequence[Literal["quantities", "weights", "curves", "bands", "missing"]] = (
        "quantities",
        "weights",
        "missing",
    )


Cell = str | float | int | bool | None


class ComparisonTable(Output):
    """Rows of cells."""

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]


class Comparison(Output):
    """Results side by side; their labels are their identifiers."""

    baseline: str
    tables: Mapping[str, ComparisonTable]
    problems: Sequence[str] = Field(description="Why results were left out.")
