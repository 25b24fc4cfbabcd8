"""Mass properties of rigid bodies, and of bodies welded together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class RigidBody:
    """Mass properties in some frame."""

    mass: float
    """[kg]"""
    centre_of_mass: np.ndarray
    """[m], shape (3,)."""
    inertia: np.ndarray
    """About the centre of mass [kg*m^2], shape (3, 3)."""

    def seen_from(self, rotation: np.ndarray, origin: np.ndarray) -> "RigidBody":
        """The body in an outer frame that holds this frame's `origin` (3,) [m] and axes `rotation` (3, 3)."""
        return RigidBody(
            mass=self.mass,
            centre_of_mass=origin + rotation @ self.centre_of_mass,
            inertia=rotation @ self.inertia @ rotation.T,
        )


def welded(bodies: Sequence[RigidBody]) -> RigidBody:
    """One body in the frame that all are given in (parallel axes theorem)."""
    mass = sum(body.mass for body in bodies)
    centre = sum((body.mass * body.centre_of_mass for body in bodies), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for body in bodies:
        d = body.centre_of_mass - centre
        inertia += body.inertia + body.mass * (d @ d * np.eye(3) - np.outer(d, d))
    return RigidBody(mass=mass, centre_of_mass=centre, inertia=inertia)
