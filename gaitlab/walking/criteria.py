"""What a walk may trade off: running criteria of the gait model.

The thesis's four (12.31)-(12.36) and two that the literature adds; each is the integral over the stride of the
expression given here. Torques in N*m, lengths in m; the quantities are compared after division by their value on
the tracked walk, so their units do not matter for the weights.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from ..errors import NotFound
from ..ocp.extremal import power_of_p_norm


@dataclass(frozen=True, kw_only=True)
class WalkState:
    """Expressions of one instant that criteria are made of."""

    tau: ca.SX
    """Joint torques in the order of q[6:] [N*m], shape (n_q - 6, 1)."""
    v: ca.SX
    """Velocities of the joints, shape (n_q - 6, 1)."""
    mass: ca.SX
    """Body mass [kg]."""
    lateral_offsets: ca.SX
    """Hip minus foot along y for right and left [m], shape (2, 1)."""
    stance: ca.SX
    """One where the right, left foot stands, shape (2, 1)."""


@dataclass(frozen=True, kw_only=True)
class Criterion:
    """A running criterion with its source."""

    name: str
    title: str
    source: str
    expression: Callable[[WalkState], ca.SX]


# Torques of q[6:]: right hip (y, x, z) = 0, 1, 2; left hip = 9, 10, 11. x is ab/adduction, z rotation.
_ADDUCTION, _ROTATION = (1, 10), (2, 11)

PEAK_EXPONENT = 8
"""Exponent of the smooth maximum; the p-norm itself is this root of the integral."""


def _peak(state: WalkState) -> ca.SX:
    # Scaled to 1 N*m/kg, a typical peak of the ankle moment in walking, so that the power neither over- nor underflows.
    return power_of_p_norm(state.tau / state.mass, PEAK_EXPONENT)


ALL: Mapping[str, Criterion] = {
    c.name: c
    for c in (
        Criterion(
            name="lateral_stability",
            title="Lateral stability",
            source="Hatz 2014, (12.31)-(12.33): squared lateral distance between hip and standing foot",
            expression=lambda s: ca.dot(s.stance, s.lateral_offsets**2),
        ),
        Criterion(
            name="torque",
            title="Effort (torque squared)",
            source="Hatz 2014, (12.34): sum of all squared joint torques",
            expression=lambda s: ca.sumsqr(s.tau),
        ),
        Criterion(
            name="hip_adduction_torque",
            title="Hip ab/adduction comfort",
            source="Hatz 2014, (12.35): squared ab/adduction torques of both hips",
            expression=lambda s: ca.sumsqr(ca.vertcat(*[s.tau[i] for i in _ADDUCTION])),
        ),
        Criterion(
            name="hip_rotation_torque",
            title="Hip rotation comfort",
            source="Hatz 2014, (12.36): squared rotation torques of both hips",
            expression=lambda s: ca.sumsqr(ca.vertcat(*[s.tau[i] for i in _ROTATION])),
        ),
        Criterion(
            name="peak_joint_moment",
            title="Peak joint moment",
            source="Smooth maximum: 8th power of joint torques per kg, the p-norm form of a minimax criterion",
            expression=_peak,
        ),
        Criterion(
            name="mechanical_power",
            title="Mechanical power",
            source="Sum of squared joint powers (tau v)^2",
            expression=lambda s: ca.sumsqr(s.tau * s.v),
        ),
    )
}

THESIS = ("lateral_stability", "torque", "hip_adduction_torque", "hip_rotation_torque")
"""Default set: the criteria of Hatz 2014, section 12.2."""


def by_name(name: str) -> Criterion:
    """Look a criterion up; raises `errors.NotFound` with the known names."""
    if name not in ALL:
        raise NotFound("criterion", name, ALL)
    return ALL[name]


def positions(names: Sequence[str]) -> list[int]:
    """Where criteria stand among `ALL`; raises `errors.NotFound` as `by_name`."""
    every = list(ALL)
    return [every.index(by_name(name).name) for name in names]
