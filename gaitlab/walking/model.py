"""The gait model as a mechanical system with contacts: dynamics, criteria, contact coordinates."""

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from ..multibody.dynamics import (
    GRAVITY,
    SEGMENT_PARAMETERS,
    ModelLayout,
    contact_positions,
    contact_velocities,
    inverse_dynamics,
    segment_origins,
)
from ..ocp.mechanical import MechanicalModel
from ..transcription.mechanical_functions import compiled_point_functions
from .criteria import ALL, WalkState

POINTS = ("right_heel", "right_toe", "left_heel", "left_toe")
"""Contact points in the order of the force components: 3 i + (x, y, z)."""

RIGHT_THIGH, LEFT_THIGH = 1, 4
"""Indices of the thigh segments, whose origins are the hip centres."""

ROOT = 6
"""Coordinates of the pelvis, which nothing actuates."""


def body_weight(layout: ModelLayout, p: ca.SX) -> ca.SX:
    """Weight of the body [N] from the parameter vector."""
    return GRAVITY * sum((p[SEGMENT_PARAMETERS * i + 6] for i in range(len(layout.parents))), start=ca.SX(0))


def walking_model(layout: ModelLayout) -> MechanicalModel:
    """Mechanical model with all criteria of `criteria.ALL`, forces in units of body weight.

    Outputs: root residual in body weights (6), joint torques [N*m] (n_q - 6), lateral hip-foot offsets [m] (2).
    """
    n_q = layout.n_q
    q, v, a = (ca.SX.sym(name, n_q) for name in "qva")
    n_joint = n_q - ROOT
    f, p, d = ca.SX.sym("f", 12), ca.SX.sym("p", layout.n_p), ca.SX.sym("d", 2)
    passive = ca.SX.sym("passive", 3 * n_joint)
    weight = body_weight(layout, p)
    forces = {name: weight * f[3 * i : 3 * i + 3] for i, name in enumerate(POINTS)}
    generalised = inverse_dynamics(layout, p, q, v, a, forces)
    positions, velocities = contact_positions(layout, p, q), contact_velocities(layout, p, q, v)
    stiffness, damping, neutral = (passive[i * n_joint : (i + 1) * n_joint] for i in range(3))
    # Ligaments and capsules carry - k (q - q_0) - c v; muscles the rest of what inverse dynamics asks for.
    active = generalised[ROOT:] + stiffness * (q[ROOT:] - neutral) + damping * v[ROOT:]
    offsets = _lateral_offsets(segment_origins(layout, p, q), positions)
    y = ca.SX.sym("y", n_q + 2)
    state = WalkState(tau=y[ROOT:n_q], v=v[ROOT:], mass=weight / GRAVITY, lateral_offsets=y[n_q:], stance=d)
    return MechanicalModel(
        q=q, v=v, a=a, f=f, p=ca.vertcat(p, passive), d=d,
        outputs=ca.vertcat(generalised[:ROOT] / weight, active, offsets),
        n_residual=ROOT,
        y=y,
        criteria=ca.vertcat(*[c.expression(state) for c in ALL.values()]),
        positions=ca.vertcat(*[positions[name] for name in POINTS]),
        velocities=ca.vertcat(*[velocities[name] for name in POINTS]),
    )  # fmt: skip


def _lateral_offsets(origins: list[ca.SX], positions: dict[str, ca.SX]) -> ca.SX:
    feet = [0.5 * (positions[f"{side}_heel"] + positions[f"{side}_toe"]) for side in ("right", "left")]
    hips = [origins[RIGHT_THIGH], origins[LEFT_THIGH]]
    return ca.vertcat(*[hip[1] - foot[1] for hip, foot in zip(hips, feet, strict=True)])


@dataclass(frozen=True)
class WalkingFunctions:
    """Compiled functions of one layout."""

    layout: ModelLayout
    functions: dict[str, ca.Function]


@lru_cache(maxsize=4)
def walking_functions(layout: ModelLayout) -> WalkingFunctions:
    """Build and compile the functions of a layout; the second call, in this process or a later one, is quick."""
    return WalkingFunctions(layout, compiled_point_functions(walking_model(layout), "walking"))
