"""Body parameters that a user may give."""

from math import pi

from ..clinical.document import SIDES
from ..mocap.subject_parameters import LENGTHS, SIDED_ANGLES, SIDED_LENGTHS

MASS_RANGE = (1.0, 500.0)  # [kg]
PLAUSIBLE = (
    {"mass": (*MASS_RANGE, "kg")}
    | {name: (low, high, "m") for name, low, high in LENGTHS.values()}
    | {f"{side}_{name}": (low, high, "m") for side in SIDES for name, low, high in SIDED_LENGTHS.values()}
    | {f"{side}_{name}": (-pi, pi, "rad") for side in SIDES for name in SIDED_ANGLES.values()}
)
"""Body parameters that may be given: lowest and highest plausible value, unit."""
