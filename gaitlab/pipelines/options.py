"""What the user may choose for an analysis."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from ..errors import InvalidSubject, NotFound, ProblemError
from ..inverse.clinical_angles import Forward
from ..inverse.leg_kinetics import InertiaConvention, MomentFrame
from ..multibody.anthropometry import AnthropometryName
from ..walking.contact_schedule import Landing
from ..walking.criteria import THESIS, by_name
from .body_parameters import PLAUSIBLE
from .corrected_events import CorrectedEvent, Corrections
from .references import ReferenceOptions

StaticOffsets = Literal["computed", "file"]


@dataclass(frozen=True, kw_only=True)
class AnalysisOptions:
    """Every choice, with its default."""

    parameters: Mapping[str, float] = field(default_factory=dict[str, float])
    """Body parameters that replace those of the files, SI units: mass, height, left_leg_length ..."""
    criteria: tuple[str, ...] = THESIS
    weights: bool = True
    """Whether to compute the walk and its weights."""
    seed: int = 0
    landing: Landing = "soft"
    """Whether feet come to rest before they touch the floor, or by an impact."""
    processes: int = 0
    """Processes that solve arcs of the walk at the same time; 0: as many as there are processors."""
    redetect_events: bool = False
    """Detect events although the file has some."""
    events: Corrections = field(default_factory=dict[str, tuple[CorrectedEvent, ...]])
    """All events of a walk, by its name, where somebody corrected them."""
    static_offsets: StaticOffsets = "computed"
    """Whether offsets computed from the static trial are used, or those stored in its file."""
    forward: Forward = "laboratory axis"
    """What pelvis rotation, foot progression and the ground reaction's forward part are measured against: the
    laboratory axis next to the walking direction, as in Plug-in Gait, or that direction itself."""
    longest_gap: float = 0.1
    """Longest gap in a marker that is filled [s]."""
    anthropometry: AnthropometryName = "corrected"
    """Table of segment masses and inertias."""
    references: ReferenceOptions = field(default_factory=ReferenceOptions)
    """Norms and scores."""
    moment_frame: MomentFrame = "distal"
    """Axes that joint moments are expressed in."""
    kinetics_inertia: InertiaConvention = "subject"
    """Mass properties behind moments and powers: the subject's model, or Plug-in Gait's, to explain a difference."""
    trunk_joint: bool = False
    """False: head, arms and trunk are rigid on the pelvis as in the thesis; True: three coordinates more."""

    def __post_init__(self) -> None:
        for name, value in self.parameters.items():
            _check_parameter(name, value)
        for name in self.criteria:
            by_name(name)
        if self.processes < 0:
            raise ProblemError(f"processes must be 0 (as many as there are processors) or more, got {self.processes}")
        if self.weights and not self.criteria:
            raise ProblemError("no criterion is left: name at least one with --criteria, or ask for --no-weights")


def _check_parameter(name: str, value: float) -> None:
    if name not in PLAUSIBLE:
        raise NotFound("body parameter", name, PLAUSIBLE)
    low, high, unit = PLAUSIBLE[name]
    if not low <= value <= high:
        raise InvalidSubject(f"{name} is {value:g}: give a value from {low:.4g} to {high:.4g} {unit}")
