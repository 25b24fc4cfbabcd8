"""The contract of `result.json`: what one analysis writes and every reader may rely on.

All lengths are metres, times seconds from the first stored frame, angles of curves degrees with the signs of the
clinical convention (flexion, adduction, internal rotation, anterior tilt, obliquity up positive). A value that could
not be computed is null, never NaN.
"""

from pathlib import Path
from typing import Any, Literal

import msgspec

from ..errors import InvalidRecording, OutputError
from ..mocap.recording import EventKind, EventSource, Side
from .kinetics_document import EmgEntry, KineticsEntry
from .prediction_document import PredictionEntry
from .score_document import ScoresEntry, StridesEntry
from .spatiotemporal import NormalisedSpatiotemporal, Spatiotemporal

CURVES = (
    "pelvis_tilt",
    "pelvis_obliquity",
    "pelvis_rotation",
    "hip_flexion",
    "hip_adduction",
    "hip_rotation",
    "knee_flexion",
    "ankle_dorsiflexion",
    "foot_progression",
)
"""The nine curves, proximal to distal, sagittal, frontal, transverse."""
SIDES: tuple[Side, Side] = ("left", "right")

SolverStatus = Literal["solved", "not_converged", "cancelled"]


class InputFile(msgspec.Struct, frozen=True, kw_only=True):
    """One file that was read."""

    name: str
    role: Literal["static", "walk"]
    sha256: str
    rate_hz: float
    n_frames: int


class SegmentEntry(msgspec.Struct, frozen=True, kw_only=True):
    """One rigid body of the subject's model."""

    name: str
    mass_kg: float
    length_m: float | None = None


class SubjectEntry(msgspec.Struct, frozen=True, kw_only=True):
    """The person as modelled."""

    mass_kg: float | None = None
    height_m: float | None = None
    parameters: dict[str, float] = {}
    """All body parameters in SI units: left_leg_length, right_knee_width ... ; lengths [m], angles [rad]."""
    assumed: list[str] = []
    """Names of parameters that neither the files nor the user gave, and that were estimated."""
    preset: str = ""
    segments: list[SegmentEntry] = []


class EventEntry(msgspec.Struct, frozen=True, kw_only=True):
    """Foot strike or foot off."""

    side: Side
    kind: EventKind
    time_s: float
    source: EventSource
    trial: str
    """File stem of the walk."""


class SideSpatiotemporal(msgspec.Struct, frozen=True, kw_only=True):
    """Distances and times of one side: mean over the cycles, standard deviation, and each cycle."""

    n_cycles: int
    mean: Spatiotemporal
    sd: Spatiotemporal
    normalised: NormalisedSpatiotemporal
    """Means made dimensionless with leg length and gravity (Hof 1996)."""
    cycles: list[Spatiotemporal]
    normalised_cycles: list[NormalisedSpatiotemporal] = []
    """Each cycle made dimensionless."""


class SpatiotemporalEntry(msgspec.Struct, frozen=True, kw_only=True):
    """Both sides."""

    left: SideSpatiotemporal | None = None
    right: SideSpatiotemporal | None = None


class Curve(msgspec.Struct, frozen=True, kw_only=True):
    """One angle over the gait cycle, 0 to 100 % in 101 samples, deg."""

    mean: list[float | None]
    sd: list[float | None]
    n_cycles: int


class CurveSides(msgspec.Struct, frozen=True, kw_only=True):
    """One curve of both sides, each on its own cycle."""

    left: Curve | None = None
    right: Curve | None = None


class CriterionWeight(msgspec.Struct, frozen=True, kw_only=True):
    """One criterion of the lower level, and how much this walk cares for it."""

    name: str
    weight: float
    """Weight of the criterion divided by its value on the tracked walk; all weights sum to one."""
    sd: float | None
    """Standard deviation of `weight`; null where not identifiable."""
    identifiable: bool
    raw_weight: float | None = None
    """Weight of the criterion in its own units."""
    cost_share: float | None = None
    """Part of the optimal cost that this criterion pays."""
    tracked_value: float | None = None
    """Value of the criterion on the tracked walk, own units."""
    at_bound: bool = False
    """True where the weight is zero because the simplex ends there."""
    interval_95: list[float] | None = None
    """Values that the data allow with 95 % confidence; at zero one-sided, with all the error above."""


class Fit(msgspec.Struct, frozen=True, kw_only=True):
    """Distance of the model-optimal walk to the measured one, root mean square [rad]."""

    rms_rad: float
    per_joint: dict[str, float]
    unseen_stride_rms_rad: dict[str, float] = {}
    """The same weights on strides that were not used to find them: stride name to rms [rad]."""


class Comparison(msgspec.Struct, frozen=True, kw_only=True):
    """The same distance for other weights [rad]: what the found weights must beat."""

    equal_weights_rms_rad: float | None = None
    single_criterion_rms_rad: dict[str, float | None] = {}


class Solver(msgspec.Struct, frozen=True, kw_only=True):
    """Certificate, recomputed by gaitlab, and effort."""

    status: SolverStatus
    kkt_residual: float | None
    iterations: int
    seconds: float
    reduced_hessian: str = ""
    """`positive definite` or what was found instead."""
    tracking_rms_rad: float | None = None
    tracking_seconds: float | None = None
    regularisation_share: float | None = None
    """Part of the optimal cost that the stated regularisation pays."""
    message: str = ""
    """Reason and hint where not solved."""


class StrideWeights(msgspec.Struct, frozen=True, kw_only=True):
    """Weights of one stride."""

    trial: str
    side: Side
    start_s: float
    end_s: float
    weights: dict[str, float]
    fit_rms_rad: float | None = None
    solver: Solver | None = None


class PooledWeights(msgspec.Struct, frozen=True, kw_only=True):
    """All strides of the person together."""

    n_strides: int
    weights: dict[str, float]
    between_stride_sd: dict[str, float | None]
    bootstrap_95: dict[str, list[float]] = {}
    """Percentile intervals of the mean weights, strides drawn with replacement; with three strides or more."""


class WeightsEntry(msgspec.Struct, frozen=True, kw_only=True):
    """What the walk trades off."""

    criteria: list[CriterionWeight]
    fit: Fit
    solver: Solver
    covariance: list[list[float | None]] = []
    """Of the weights in the order of `criteria`."""
    not_told_apart: list[list[str]] = []
    """Pairs of criteria of which one could take over the other's weight without a worse fit than chance."""
    correlation: list[list[float | None]] = []
    comparison: Comparison | None = None
    strides: list[StrideWeights] = []
    pooled: PooledWeights | None = None
    notes: list[str] = []
    """What a reader should know about these weights, sentences."""


class GapEntry(msgspec.Struct, frozen=True, kw_only=True):
    """Missing frames of one marker."""

    trial: str
    marker: str
    start_s: float
    end_s: float
    filled: bool


class CalibrationEntry(msgspec.Struct, frozen=True, kw_only=True):
    """Offsets of the conventional gait model [rad], signs of Vicon's PROCESSING group; of several walks the first's."""

    used: str
    """Which offsets were used, and how the knee axis was found, in words."""
    computed: dict[str, float]
    """left_thigh_rotation ... computed from the static trial; empty without one."""
    stored: dict[str, float]
    """The same as stored in the files, where they are."""


class QualityEntry(msgspec.Struct, frozen=True, kw_only=True):
    """How far the numbers can be trusted."""

    gaps: list[GapEntry] = []
    calibration: CalibrationEntry | None = None
    marker_residual_rms_m: float | None = None
    """Whole-model least squares: distance of model markers to measured ones."""
    marker_residuals_m: dict[str, float | None] = {}
    """The same per marker."""


class Document(msgspec.Struct, frozen=True, kw_only=True):
    """One analysis."""

    version: str
    inputs: list[InputFile]
    subject: SubjectEntry
    events: list[EventEntry]
    spatiotemporal: SpatiotemporalEntry
    kinematics: dict[str, CurveSides]
    kinetics: KineticsEntry | None = None
    """Moments, powers and ground reactions, and why some are missing."""
    emg: EmgEntry | None = None
    """Null where the files hold no EMG."""
    weights: WeightsEntry | None
    """Null when not asked for, or when nothing could be computed: then `warnings` says why."""
    quality: QualityEntry
    settings: dict[str, Any]
    """Every setting that shaped the result, by name."""
    warnings: list[str]
    strides: StridesEntry | None = None
    """All strides of all trials: outliers, representative stride, consistency."""
    scores: ScoresEntry | None = None
    """Gait variable and profile scores, gait deviation index, and the norms that they refer to."""
    prediction: PredictionEntry | None = None
    """Only in results of `gaitlab predict`: what was changed, the way there, and what it changes."""
    environment: dict[str, str] = {}
    """Versions and machine that computed it, by name; never the machine's name."""


def schema() -> dict[str, Any]:
    """JSON schema of `result.json`."""
    return msgspec.json.schema(Document)


def encode(document: Document) -> bytes:
    """Indented JSON, UTF-8; NaN and infinity become null."""
    return msgspec.json.format(msgspec.json.encode(document), indent=2) + b"\n"


def write_document(document: Document, path: Path) -> None:
    """Write `result.json`."""
    try:
        path.write_bytes(encode(document))
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def read_document(path: Path) -> Document:
    """Read and check `result.json`."""
    try:
        return msgspec.json.decode(path.read_bytes(), type=Document)
    except OSError as error:
        raise InvalidRecording(f"{path} cannot be read ({error.strerror}): give a folder made by gaitlab") from error
    except msgspec.DecodeError as error:
        raise InvalidRecording(f"{path} is not a gaitlab result: {error}") from error
