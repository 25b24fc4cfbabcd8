"""Parts of `result.json` that judge: strides over trials, reference, scores."""

import msgspec

from ..mocap.recording import Side
from .normative import ReferenceBand, ReferenceValue


class StrideEntry(msgspec.Struct, frozen=True, kw_only=True):
    """One stride."""

    trial: str
    side: Side
    start_s: float
    end_s: float
    complete: bool
    """Whether all nine curves are known over the whole cycle."""
    outlier: list[str] = []
    """Why this stride differs from the others; empty for most. It stays in the means."""
    representative: bool = False
    """True for the stride of its side that is closest to the median stride."""


class ConsistencyEntry(msgspec.Struct, frozen=True, kw_only=True):
    """How alike the strides of one side are in one curve."""

    sd_deg: float
    cmc: float | None
    n_strides: int


class StridesEntry(msgspec.Struct, frozen=True, kw_only=True):
    """All strides of all trials."""

    strides: list[StrideEntry]
    consistency: dict[str, dict[Side, ConsistencyEntry]] = {}
    """By curve and side."""
    rule: str = ""
    """How outliers are found, in words."""


class ReferenceEntry(msgspec.Struct, frozen=True, kw_only=True):
    """The band that the curves were compared with, in full, so that the result can be read without the norm file."""

    description: str
    """Source, n, age and speed, as printed beside the band."""
    source: str
    licence: str
    n: int
    age_years: tuple[float, float] | None
    speed_bin: str
    curves: dict[str, ReferenceBand]
    """Angles [deg]."""
    kinetics: dict[str, ReferenceBand] = {}
    """Moments [N*m/kg], powers [W/kg] and ground reactions [% of body weight]."""
    emg: dict[str, ReferenceBand] = {}
    """Envelopes by muscle, part of a maximum."""
    spatiotemporal: dict[str, ReferenceValue] = {}
    """Dimensionless values are multiplied out with this person's mean leg length."""
    gvs: dict[str, ReferenceValue] = {}
    gps: ReferenceValue | None = None
    weights: dict[str, ReferenceValue] = {}
    """Weights of the criteria, where the cohort has some."""


class SideScores(msgspec.Struct, frozen=True, kw_only=True):
    """Scores of one side."""

    gvs: dict[str, float]
    """Gait variable scores of the mean curves, deg: the movement analysis profile."""
    gps: float | None
    """Gait profile score of the mean curves, deg."""
    gps_sd: float | None = None
    """Sample standard deviation of the scores of the single cycles, deg."""
    n_cycles: int = 0
    """Cycles whose nine curves are complete."""
    gdi: float | None = None


class ScoresEntry(msgspec.Struct, frozen=True, kw_only=True):
    """Gait variable scores, gait profile score and gait deviation index, with what they refer to."""

    reference: ReferenceEntry | None
    left: SideScores | None = None
    right: SideScores | None = None
    gps_overall: float | None = None
    """Of 15 variables: both sides, the pelvis once, from the left; deg."""
    gdi_reference: str = ""
    missing: list[str] = []
    """What could not be computed, and why."""
