"""What a prediction may change, as `walking.quantities` knows it.

Written down a second time for the reason that `choices` gives; a test compares both.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import get_args

from ..errors import NotFound
from .choices import CriterionName

SIDES = ("left", "right")
JOINT_ANGLES = ("hip_flexion", "hip_adduction", "hip_rotation", "knee_flexion", "ankle_dorsiflexion")
MUSCLES = (
    "hip_flexor",
    "hip_extensor",
    "hip_adductor",
    "hip_abductor",
    "knee_flexor",
    "knee_extensor",
    "ankle_dorsiflexor",
    "ankle_plantarflexor",
)


@dataclass(frozen=True)
class Quantity:
    """Unit and plausible values of one quantity."""

    unit: str
    lowest: float
    highest: float
    relative_to: str = ""
    """What a change in per cent refers to; empty where only a number makes sense."""


def _of_side(side: str) -> dict[str, Quantity]:
    body = "the identified body"
    parts = ("thigh", "shank", "foot")
    lengths = {f"{side}_{part}_length": Quantity("m", 0.02, 0.8, body) for part in parts}
    masses = {f"{side}_{part}_mass": Quantity("kg", 0.05, 60.0, body) for part in parts}
    torsions = {f"{side}_{bone}_torsion": Quantity("deg", -60.0, 60.0) for bone in ("femoral", "tibial")}
    limits = {
        f"{side}_{angle}_{end}": Quantity("deg", -150.0, 150.0) for angle in JOINT_ANGLES for end in ("min", "max")
    }
    peak = "the peak of the identified gait"
    torques = {f"{side}_{muscle}_limit": Quantity("N*m", 0.0, 1000.0, peak) for muscle in MUSCLES}
    orthosis = {
        f"{side}_ankle_orthosis": Quantity("N*m/deg", 0.0, 50.0),
        f"{side}_ankle_orthosis_neutral": Quantity("deg", -60.0, 60.0),
    }
    return lengths | masses | torsions | limits | torques | orthosis


QUANTITIES: Mapping[str, Quantity] = {
    "speed": Quantity("m/s", 0.05, 4.0, "the identified gait"),
    "step_length": Quantity("m", 0.02, 1.5, "the identified gait"),
    "cadence": Quantity("steps/min", 10.0, 300.0, "the identified gait"),
    "mass": Quantity("kg", 2.0, 300.0, "the identified body"),
    "pelvis_mass": Quantity("kg", 0.5, 200.0, "the identified body"),
    **{f"{name}_weight": Quantity("", 0.0, 1.0, "the identified weight") for name in get_args(CriterionName)},
} | {name: quantity for side in SIDES for name, quantity in _of_side(side).items()}
"""All quantities by name."""


def check_change(text: str) -> str:
    """The change itself, if its quantity exists.

    Raises:
        NotFound: There is no such quantity.
    """
    name = text.partition("=")[0]
    if name not in QUANTITIES:
        raise NotFound("quantity", name, QUANTITIES)
    return text
