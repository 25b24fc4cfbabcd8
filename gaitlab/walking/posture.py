r"""The posture that loads the joints least: feet where they were measured, trunk upright.

A static problem for the black-box optimiser, after the humanoid example of Sovukluk and Ott (2025, section 4.5): the
coordinates q minimise

.. math:: \Big|\frac{\tau_{joint}}{m g \, l}\Big|^2 + c \, |q - q_{measured}|^2

where the ground forces balance the body and are shared between the contact points so that the joint torques are least.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..inverse.kinematics_settings import InverseKinematicsSettings
from ..multibody.dynamics import (
    GRAVITY,
    ModelLayout,
    contact_positions,
    inverse_dynamics,
    layout_of,
    parameter_vector,
    segment_rotations,
)
from ..multibody.subject import SubjectModel
from ..nlp.null_space.method import BlackBoxSolution, NullSpaceProjection
from ..nlp.null_space.problem import BlackBoxProblem
from .model import ROOT

LEVER = 0.1
"""Lever l [m]: the torque of the body's weight on it counts as one."""

FORCE_WEIGHT = 1e-3
"""Weight of squared ground forces in body weights: decides what torques leave open, such as heel against toe."""


SOFTNESS = 1e-10
"""Keeps the balance solvable where two points cannot balance the body; a share of its weight is left then."""

MANY = 256
"""Postures whose load is remembered: those of one gradient."""


@dataclass(frozen=True, kw_only=True)
class StaticLoad:
    """What it takes to hold a posture."""

    torques: np.ndarray
    """Of the joints, q[6:] [N*m], shape (n_q - 6,)."""
    forces: np.ndarray
    """Of the ground on the contact points, gait frame [N], shape (n_points, 3)."""
    unbalanced: np.ndarray
    """Force [N] and moment [N*m] on the root that no ground force can balance, shape (6,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PostureProblem:
    """A measured posture to be improved.

    Raises:
        ProblemError: The coordinates have another shape, or are not finite.
    """

    subject: SubjectModel
    measured: np.ndarray
    """Measured coordinates [m, rad], shape (n_q,)."""
    closeness: float = 0.1
    """Weight c of a deviation of 1 rad or 1 m from the measured coordinates: holds what bears no load."""
    ranges: InverseKinematicsSettings = field(default_factory=InverseKinematicsSettings)
    """Whose joint ranges limit the coordinates."""

    def __post_init__(self) -> None:
        if self.measured.shape != (self.subject.n_q,) or not np.all(np.isfinite(self.measured)):
            raise ProblemError(f"measured must be finite with shape ({self.subject.n_q},), got {self.measured.shape}")

    @property
    def weight(self) -> float:
        """Body weight [N]."""
        return GRAVITY * self.subject.mass

    def load(self, q: np.ndarray) -> StaticLoad:
        """Torques and ground forces at coordinates q, shape (n_q,).

        Least squares of torques and forces under the root's balance, solved through its optimality conditions.
        """
        return self._load_of(q.tobytes())

    def cost(self, q: np.ndarray) -> float:
        """Joint load and closeness at q, shape (n_q,)."""
        torques = self.load(q).torques / (LEVER * self.weight)
        return float(torques @ torques + self.closeness * np.sum((q - self.measured) ** 2))

    def equality(self, q: np.ndarray) -> np.ndarray:
        """Feet off their places [m] and lean of the trunk at q (n_q,), shape (3 n_points + 2,); then the balance.

        What the ground cannot balance [body weights, m], six rows more, is left out where three points stand, as they
        balance any posture.
        """
        points, lean = (out.full().ravel() for out in self._functions["places"](q))
        balance = np.zeros(0) if self._balanced else self.load(q).unbalanced / self.weight
        return np.concatenate([points - self._measured_places, lean, balance])

    def inequality(self, q: np.ndarray) -> np.ndarray:
        """Pull of the ground in body weights, then joints beyond their ranges [rad], at q (n_q,): shape (n_ic,)."""
        low, high = self.ranges.limits(self.subject)
        outside = np.concatenate([(low - q)[np.isfinite(low)], (q - high)[np.isfinite(high)]])
        return np.concatenate([-self.load(q).forces[:, 2] / self.weight, outside])

    def black_box(self) -> BlackBoxProblem:
        """The problem for the optimiser; feet first, then the trunk."""
        names = [f"{point} {axis}" for point in self.subject.contacts for axis in "xyz"]
        names += ["trunk forward", "trunk sideways"]
        names += [] if self._balanced else [f"balance {i}" for i in range(ROOT)]
        return BlackBoxProblem(
            cost=self.cost, equality=self.equality, inequality=self.inequality, equality_names=tuple(names)
        )

    @cached_property
    def _balanced(self) -> bool:
        return int(np.linalg.matrix_rank(self._functions["load"](self.measured)[1].full()[:ROOT], tol=1e-3)) == ROOT

    @cached_property
    def _measured_places(self) -> np.ndarray:
        return self._functions["places"](self.measured)[0].full().ravel()

    @cached_property
    def _load_of(self) -> Callable[[bytes], StaticLoad]:
        """Load for the bytes of q; remembers the last ones, as cost and constraints ask for the same posture."""
        return lru_cache(maxsize=MANY)(self._computed_load)

    def _computed_load(self, q: bytes) -> StaticLoad:
        free, spread = (out.full() for out in self._functions["load"](np.frombuffer(q)))
        free, n_f = free.ravel(), spread.shape[1]
        # With the forces in body weights and the torques on the lever, all entries are of order one.
        A, a = spread[ROOT:] / LEVER, free[ROOT:] / (LEVER * self.weight)
        B, b = spread[:ROOT], free[:ROOT] / self.weight
        kkt = np.block([[A.T @ A + FORCE_WEIGHT * np.eye(n_f), B.T], [B, -SOFTNESS * np.eye(ROOT)]])
        share = np.linalg.solve(kkt, np.concatenate([-A.T @ a, -b]))[:n_f] * self.weight
        return StaticLoad(
            torques=free[ROOT:] + spread[ROOT:] @ share,
            forces=share.reshape(-1, 3),
            unbalanced=free[:ROOT] + spread[:ROOT] @ share,
        )

    @cached_property
    def _functions(self) -> dict[str, ca.Function]:
        layout = layout_of(self.subject)
        q, p = ca.SX.sym("q", layout.n_q), ca.SX(parameter_vector(self.subject))
        still, f = ca.SX(layout.n_q, 1), ca.SX.sym("f", 3 * len(layout.contact_names))
        forces = {name: f[3 * i : 3 * i + 3] for i, name in enumerate(layout.contact_names)}
        generalised = inverse_dynamics(layout, p, q, still, still, forces)
        free = ca.substitute(generalised, f, ca.SX.zeros(f.numel(), 1))
        places = ca.vertcat(*contact_positions(layout, p, q).values())
        return {
            "load": ca.Function("load", [q], [ca.densify(free), ca.densify(ca.jacobian(generalised, f))]),
            "places": ca.Function("places", [q], [places, self._lean(layout, p, q)]),
        }

    def _lean(self, layout: ModelLayout, p: ca.SX, q: ca.SX) -> ca.SX:
        """Horizontal components of the direction from the trunk's joint to its centre of mass, shape (2, 1)."""
        names = [segment.name for segment in self.subject.segments]
        trunk = names.index("trunk") if "trunk" in names else 0
        centre = self.subject.segments[trunk].centre_of_mass
        return (segment_rotations(layout, p, q)[trunk] @ ca.SX(centre / np.linalg.norm(centre)))[:2]


METHOD = NullSpaceProjection(cost_tol=5e-5, patience=10, max_iter=300)
"""Ends when ten iterations together gain less than 5e-5 (1 + cost)."""


def least_load_posture(problem: PostureProblem, method: NullSpaceProjection = METHOD) -> BlackBoxSolution:
    """Coordinates q that load the joints least, from the measured ones; which constraint fails is in the reason."""
    return method.solve(problem.black_box(), problem.measured)
