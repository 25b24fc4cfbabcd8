"""What the user may choose for an analysis."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from typing import Literal

from ..errors import InvalidSubject, ProblemError
from ..multibody.presets import PRESETS

THESIS_CRITERIA = ("stability", "torque", "hip_adduction_torque", "hip_rotation_torque")
"""Default criteria, thesis (12.31)-(12.36)."""
LARGEST = {"mass": 500.0, "height": 2.6}
"""Above these [kg, m] a body parameter is taken for a mistake of units."""
LARGEST_LENGTH = 1.5  # [m], of a leg; widths are far below
SIGNED = ("rotation", "torsion", "flexion", "plantar", "offset", "adduction")
"""Parameters whose names hold one of these words are angles or offsets and may be negative."""

StaticOffsets = Literal["computed", "file"]


@dataclass(frozen=True, kw_only=True)
class AnalysisOptions:
    """Every choice, with its default."""

    parameters: Mapping[str, float] = field(default_factory=dict[str, float])
    """Body parameters that replace those of the files, SI units: mass, height, left_leg_length ..."""
    criteria: tuple[str, ...] = THESIS_CRITERIA
    weights: bool = True
    """Whether to compute the walk and its weights."""
    seed: int = 0
    redetect_events: bool = False
    """Detect events although the file has some."""
    static_offsets: StaticOffsets = "computed"
    """Whether offsets computed from the static trial are used, or those stored in its file."""
    preset: str = "thesis"
    longest_gap: float = 0.1
    """Longest gap in a marker that is filled [s]."""
    cut_off: float = 6.0
    """Cut-off of the zero-lag filter of markers for the dynamic walk [Hz] (Winter 2009, ch. 3)."""

    def __post_init__(self) -> None:
        for name, value in self.parameters.items():
            _check_parameter(name, value)
        if self.weights and not self.criteria:
            raise ProblemError("no criterion is left: name at least one with --criteria, or ask for --no-weights")
        if self.preset not in PRESETS:
            raise ProblemError(f"preset '{self.preset}' does not exist; available: {', '.join(sorted(PRESETS))}")


def _check_parameter(name: str, value: float) -> None:
    if not isfinite(value):
        raise InvalidSubject(f"{name} is {value}: give a number")
    if any(word in name for word in SIGNED):
        return
    if value <= 0.0:
        raise InvalidSubject(f"{name} is {value:g}: it must be greater than zero, in kg or m")
    largest = LARGEST.get(name, LARGEST_LENGTH)
    if value > largest:
        raise InvalidSubject(f"{name} is {value:g}: more than {largest:g} kg or m is impossible; are the units right?")
