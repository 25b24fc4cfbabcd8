"""Masses, centres of mass and radii of gyration of body segments, as fractions of body mass and segment length.

Sources: thesis Tables 12.4-12.6 and P. de Leva, Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters,
J. Biomech. 29 (1996) 1223-1230, Table 4 (thigh HJC-KJC, shank KJC-AJC, foot HEEL-TTIP, arms SJC-EJC-WJC, trunk in three
parts CERV-XYPH-OMPH-MIDH, head VERT-CERV).

The thesis's table is de Leva's for men with slips: its masses sum to 0.9604 because the thigh's 0.1416 lost a foot
(0.1416 - 0.0137 = 0.1279) and the hands (0.0061 each) are left out; distances of the trunk's and the head's centres of
mass from the upper end are used from the lower end; the radii of foot and head stand in another order of axes; the
right shank's 0.4365 should be 0.4395. `PRINTED` keeps all of this, `CORRECTED` sums to one and is for real people.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

AnthropometryName = Literal["printed", "corrected", "de_leva_male", "de_leva_female"]


@dataclass(frozen=True, kw_only=True)
class SegmentFractions:
    """Inertial numbers of one segment."""

    mass: float
    """Fraction of the body mass."""
    centre_of_mass: float
    """Along the segment's z axis from its origin, fraction of the segment's length; negative below the joint."""
    radii: tuple[float, float, float]
    """Radii of gyration about x, y, z through the centre of mass, fractions of the segment's length."""
    length: float
    """Mean length as fraction of the body height, used where the person's own is not measured."""

    def inertia(self, mass: float, length: float) -> np.ndarray:
        """Inertia about the centre of mass [kg*m^2], segment's axes, shape (3, 3): m (l r)^2 on the diagonal."""
        return np.diag([mass * (length * radius) ** 2 for radius in self.radii])


Fractions = Mapping[str, SegmentFractions]
"""pelvis, trunk_middle, trunk_upper, head, arm_upper, arm_lower, thigh, shank, foot: one side each."""


def _fractions(rows: Mapping[str, tuple[float, float, float, float, float, float]]) -> dict[str, SegmentFractions]:
    """Rows of mass, centre of mass, radii about x, y, z, length / height."""
    return {
        name: SegmentFractions(mass=mass, centre_of_mass=centre, radii=(x, y, z), length=length)
        for name, (mass, centre, x, y, z, length) in rows.items()
    }


# Lengths: de Leva's means over his men's height 1.741 m (trunk and head: lower, middle, upper 2, head 2).
PRINTED = _fractions(
    {
        "pelvis": (0.1117, 0.6115, 0.615, 0.551, 0.587, 0.0837),
        "trunk_middle": (0.1633, 0.4502, 0.482, 0.383, 0.468, 0.1238),
        "trunk_upper": (0.1596, 0.5066, 0.505, 0.320, 0.465, 0.1391),
        "head": (0.0694, 0.5002, 0.303, 0.261, 0.315, 0.1395),
        "arm_upper": (0.0271, -0.5772, 0.285, 0.269, 0.158, 0.1618),
        "arm_lower": (0.0162, -0.4574, 0.276, 0.265, 0.121, 0.1545),
        "thigh": (0.1279, -0.4095, 0.329, 0.329, 0.149, 0.2425),
        "shank": (0.0433, -0.4395, 0.251, 0.246, 0.102, 0.2493),
        "foot": (0.0137, -0.4, 0.124, 0.245, 0.257, 0.0962),
    }
)
"""Thesis Tables 12.4-12.6 as printed (left side; the right shank's centre of mass is printed as -0.4365)."""

# Lower arm and hand are one segment, combined from de Leva's two with his lengths. The foot's length is ours, ankle to
# toe marker; heel to toe tip is 1.54 times that (0.1482 of 1.46 m against the 0.1405 m of Table 12.6), which turns
# de Leva's radii 0.257, 0.245, 0.124; with the ankle 0.18 before the heel, 0.4415 from the heel is 0.40 from the ankle.
DE_LEVA_MALE = _fractions(
    {
        "pelvis": (0.1117, 0.3885, 0.615, 0.551, 0.587, 0.0837),
        "trunk_middle": (0.1633, 0.5498, 0.482, 0.383, 0.468, 0.1238),
        "trunk_upper": (0.1596, 0.4934, 0.505, 0.320, 0.465, 0.1391),
        "head": (0.0694, 0.4998, 0.303, 0.315, 0.261, 0.1395),
        "arm_upper": (0.0271, -0.5772, 0.285, 0.269, 0.158, 0.1618),
        "arm_lower": (0.0223, -0.6751, 0.439, 0.429, 0.123, 0.1545),
        "thigh": (0.1416, -0.4095, 0.329, 0.329, 0.149, 0.2425),
        "shank": (0.0433, -0.4395, 0.251, 0.246, 0.102, 0.2493),
        "foot": (0.0137, -0.4, 0.396, 0.377, 0.191, 0.0962),
    }
)
"""De Leva's men."""

DE_LEVA_FEMALE = _fractions(
    {
        "pelvis": (0.1247, 0.5080, 0.433, 0.402, 0.444, 0.1046),
        "trunk_middle": (0.1465, 0.5488, 0.433, 0.354, 0.415, 0.1183),
        "trunk_upper": (0.1545, 0.4950, 0.466, 0.314, 0.449, 0.1314),
        "head": (0.0668, 0.5159, 0.271, 0.295, 0.261, 0.1405),
        "arm_upper": (0.0255, -0.5754, 0.278, 0.260, 0.148, 0.1586),
        "arm_lower": (0.0194, -0.6766, 0.419, 0.415, 0.095, 0.1523),
        "thigh": (0.1478, -0.3612, 0.369, 0.364, 0.162, 0.2124),
        "shank": (0.0481, -0.4352, 0.267, 0.263, 0.092, 0.2492),
        "foot": (0.0129, -0.34, 0.460, 0.430, 0.214, 0.0855),
    }
)
"""De Leva's women, laid out as the men."""

CORRECTED = DE_LEVA_MALE
"""The thesis's table after the corrections named above: de Leva's men."""

TABLES: Mapping[AnthropometryName, Fractions] = {
    "printed": PRINTED,
    "corrected": CORRECTED,
    "de_leva_male": DE_LEVA_MALE,
    "de_leva_female": DE_LEVA_FEMALE,
}


def total_mass_fraction(fractions: Fractions) -> float:
    """Sum of all fourteen segments' fractions of the body mass: 1 but for `PRINTED`, where it is 0.9604."""
    twice = {"arm_upper", "arm_lower", "thigh", "shank", "foot"}
    return sum((2 if name in twice else 1) * fraction.mass for name, fraction in fractions.items())


def with_right_shank_as_printed(fractions: Fractions) -> dict[str, SegmentFractions]:
    """The same table with the centre of mass that Table 12.5 prints for the right shank."""
    return {**fractions, "shank": replace(fractions["shank"], centre_of_mass=-0.4365)}
