"""What may be set for a prediction: names, units, plausible values, and what a value changes.

Signs of coordinates (Y'X'Z', y left): hip flexion and ankle dorsiflexion are -y, knee flexion is +y; adduction and
internal rotation are +x and +z on the right, -x and -z on the left.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Literal

import numpy as np

from ..errors import NotFound
from ..multibody.body_change import segment_length
from ..multibody.subject import SubjectModel
from ..transcription.output_limits import OutputLimit
from .criteria import ALL
from .identified_gait import IdentifiedGait
from .model import ROOT

Kind = Literal[
    "task", "mass", "length", "segment mass", "torsion", "lowest angle", "highest angle", "torque", "orthosis", "weight"
]
SIDES = ("left", "right")
DEGREE = pi / 180.0
WEIGHT = "_weight"
"""End of the names of weights, after that of their criterion."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One thing that can be set."""

    name: str
    unit: str
    kind: Kind
    meaning: str
    lowest: float
    highest: float
    relative_to: str = ""
    """What a change in percent refers to; empty where only a number makes sense."""
    coordinate: int = -1
    """Index into q, for joints."""
    sign: float = 1.0
    """Of the coordinate or torque that the quantity limits."""
    segment: str = ""


JOINT_ANGLES = {
    "hip_flexion": (0, 0, -1.0, -1.0),
    "hip_adduction": (0, 1, 1.0, -1.0),
    "hip_rotation": (0, 2, 1.0, -1.0),
    "knee_flexion": (1, 0, 1.0, 1.0),
    "ankle_dorsiflexion": (2, 0, -1.0, -1.0),
}
"""Joint below the hip, axis (y, x, z), sign on the right, sign on the left."""

MUSCLES = {
    "hip_flexor": ("hip_flexion", 1.0),
    "hip_extensor": ("hip_flexion", -1.0),
    "hip_adductor": ("hip_adduction", 1.0),
    "hip_abductor": ("hip_adduction", -1.0),
    "knee_flexor": ("knee_flexion", 1.0),
    "knee_extensor": ("knee_flexion", -1.0),
    "ankle_dorsiflexor": ("ankle_dorsiflexion", 1.0),
    "ankle_plantarflexor": ("ankle_dorsiflexion", -1.0),
}
"""Angle that the muscles increase (1) or decrease (-1)."""


def _joint(side: str, angle: str) -> tuple[int, float]:
    """Coordinate of a joint's angle and its sign."""
    below, axis, right, left = JOINT_ANGLES[angle]
    first = ROOT + (0 if side == "right" else 9)
    return first + 3 * below + axis, right if side == "right" else left


def _task() -> list[Quantity]:
    return [
        Quantity(name="speed", unit="m/s", kind="task", meaning="mean walking speed; kept unless given",
                 lowest=0.05, highest=4.0, relative_to="the identified gait"),
        Quantity(name="step_length", unit="m", kind="task", meaning="mean of both steps; follows unless given",
                 lowest=0.02, highest=1.5, relative_to="the identified gait"),
        Quantity(name="cadence", unit="steps/min", kind="task", meaning="follows unless given",
                 lowest=10.0, highest=300.0, relative_to="the identified gait"),
    ]  # fmt: skip


def _weights() -> list[Quantity]:
    return [
        Quantity(name=f"{name}{WEIGHT}", unit="", kind="weight", lowest=0.0, highest=1.0,
                 meaning="weight of this criterion; those not given keep their proportions",
                 relative_to="the identified weight")
        for name in ALL
    ]  # fmt: skip


def _body(side: str) -> list[Quantity]:
    lengths = [
        Quantity(name=f"{side}_{kind}_length", unit="m", kind="length", segment=f"{side}_{kind}",
                 meaning="joint to joint" if kind != "foot" else "heel to toe contact",
                 lowest=0.02, highest=0.8, relative_to="the identified body")
        for kind in ("thigh", "shank", "foot")
    ]  # fmt: skip
    masses = [
        Quantity(name=f"{side}_{kind}_mass", unit="kg", kind="segment mass", segment=f"{side}_{kind}",
                 meaning="with its inertia", lowest=0.05, highest=60.0, relative_to="the identified body")
        for kind in ("thigh", "shank", "foot")
    ]  # fmt: skip
    inward = 1.0 if side == "right" else -1.0
    torsions = [
        Quantity(name=f"{side}_femoral_torsion", unit="deg", kind="torsion", segment=f"{side}_thigh", sign=inward,
                 meaning="added anteversion: knee and foot turned inwards", lowest=-60.0, highest=60.0),
        Quantity(name=f"{side}_tibial_torsion", unit="deg", kind="torsion", segment=f"{side}_shank", sign=-inward,
                 meaning="added external torsion: foot turned outwards", lowest=-60.0, highest=60.0),
    ]  # fmt: skip
    return lengths + masses + torsions


def _joints(side: str) -> list[Quantity]:
    found: list[Quantity] = []
    for angle in JOINT_ANGLES:
        coordinate, sign = _joint(side, angle)
        ends: tuple[tuple[Kind, str], ...] = (("lowest angle", "min"), ("highest angle", "max"))
        for kind, word in ends:
            found.append(
                Quantity(name=f"{side}_{angle}_{word}", unit="deg", kind=kind, coordinate=coordinate, sign=sign,
                         meaning=f"{kind} that the joint allows", lowest=-150.0, highest=150.0)
            )  # fmt: skip
    for muscle, (angle, direction) in MUSCLES.items():
        coordinate, sign = _joint(side, angle)
        found.append(
            Quantity(name=f"{side}_{muscle}_limit", unit="N*m", kind="torque", coordinate=coordinate,
                     sign=sign * direction, meaning="largest torque of these muscles", lowest=0.0, highest=1000.0,
                     relative_to="the peak of the identified gait")
        )  # fmt: skip
    ankle = _joint(side, "ankle_dorsiflexion")
    found.append(
        Quantity(name=f"{side}_ankle_orthosis", unit="N*m/deg", kind="orthosis", coordinate=ankle[0], sign=ankle[1],
                 meaning="stiffness of an ankle-foot orthosis", lowest=0.0, highest=50.0)
    )  # fmt: skip
    found.append(
        Quantity(name=f"{side}_ankle_orthosis_neutral", unit="deg", kind="orthosis", coordinate=ankle[0], sign=ankle[1],
                 meaning="dorsiflexion at which it is free of load; 0 unless given", lowest=-60.0, highest=60.0)
    )  # fmt: skip
    return found


QUANTITIES: Mapping[str, Quantity] = {
    q.name: q
    for q in [
        *_task(),
        Quantity(name="mass", unit="kg", kind="mass", meaning="of the whole body", lowest=2.0, highest=300.0,
                 relative_to="the identified body"),
        Quantity(name="pelvis_mass", unit="kg", kind="segment mass", segment="pelvis", lowest=0.5, highest=200.0,
                 meaning="pelvis, and with it a rigid trunk, arms and head", relative_to="the identified body"),
        *_weights(),
        *(q for side in SIDES for q in _body(side)),
        *(q for side in SIDES for q in _joints(side)),
    ]
}  # fmt: skip
"""All quantities by name."""


@dataclass(frozen=True, eq=False)
class Present:
    """Values of the quantities in the identified gait."""

    gait: IdentifiedGait

    @property
    def subject(self) -> SubjectModel:
        """The identified body."""
        return self.gait.stride.subject

    @cached_property
    def states(self) -> np.ndarray:
        """States at the nodes, shape (N + 1, 2 n_q)."""
        return self.gait.states

    @cached_property
    def torques(self) -> np.ndarray:
        """Joint torques at the Gauss points [N*m], shape (2 N, n_q - 6)."""
        return self.gait.problem.outputs(self.gait.solution.w)[:, ROOT : self.subject.n_q]

    @property
    def speed(self) -> float:
        """Mean walking speed [m/s]."""
        return self.gait.length / self.gait.duration

    def value(self, quantity: Quantity) -> float:
        """Value of a quantity in its own unit."""
        match quantity.kind:
            case "task":
                return {"speed": self.speed, "step_length": 0.5 * self.gait.length}.get(
                    quantity.name, 120.0 / self.gait.duration
                )
            case "mass":
                return self.subject.mass
            case "segment mass":
                return next(s.mass for s in self.subject.segments if s.name == quantity.segment)
            case "length":
                return segment_length(self.subject, quantity.segment)
            case "torque":
                return float(np.max(quantity.sign * self.torques[:, quantity.coordinate - ROOT]))
            case "lowest angle":
                return float(np.min(quantity.sign * self.states[:, quantity.coordinate])) / DEGREE
            case "highest angle":
                return float(np.max(quantity.sign * self.states[:, quantity.coordinate])) / DEGREE
            case "torsion" | "orthosis":
                return 0.0
            case "weight":
                return float(self.gait.weights[self.criterion(quantity)])

    def criterion(self, quantity: Quantity) -> int:
        """Index of a weight's criterion; raises `errors.NotFound` where the gait was explained without it."""
        name = quantity.name.removesuffix(WEIGHT)
        if name not in self.gait.criteria:
            raise NotFound("criterion of the identified gait", name, self.gait.criteria)
        return self.gait.criteria.index(name)


def torque_limit(quantity: Quantity) -> OutputLimit:
    """The limit that a quantity of the kind "torque" sets."""
    return OutputLimit(output=quantity.coordinate, sign=quantity.sign)
