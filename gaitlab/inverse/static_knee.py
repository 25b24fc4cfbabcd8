"""The knee alignment device: a KNE marker where there is none."""

from collections.abc import Mapping

import numpy as np

from gaitlab.inverse.conventional_calibration import SIGN
from gaitlab.inverse.conventional_geometry import cross, norm, unit
from gaitlab.mocap.recording import Side

TIPS = ("KAX", "KD1", "KD2")


def wears_device(markers: Mapping[str, np.ndarray], side: Side) -> bool:
    """Whether the three tips of the knee alignment device, each (n, 3), are ever seen together."""
    tips = [markers.get(side[0].upper() + tip) for tip in TIPS]
    found = [tip for tip in tips if tip is not None]
    return len(found) == len(TIPS) and bool(np.isfinite(np.hstack(found)).all(axis=1).any())


def knee_marker(markers: Mapping[str, np.ndarray], side: Side) -> dict[str, np.ndarray]:
    """{"LKNE": positions (n, 3) [m]} where the knee alignment device stands for the marker, else nothing.

    The device's tips lie on three perpendicular rods of equal length from the place of the marker, so they form an
    equilateral triangle of edge e at the height e / sqrt(6) above it, laboratory frame.
    """
    name = side[0].upper() + "KNE"
    marker = markers.get(name)
    if (marker is not None and np.isfinite(marker).any()) or not wears_device(markers, side):
        return {}
    return {name: device_apex(markers, side)}


def device_apex(markers: Mapping[str, np.ndarray], side: Side) -> np.ndarray:
    """Where the rods of the knee alignment device meet, laboratory frame [m], shape (n, 3)."""
    axis, first, second = (markers[side[0].upper() + tip] for tip in TIPS)
    edge = (norm(axis - first) + norm(axis - second) + norm(first - second)) / 3
    normal = unit(cross(first - axis, second - axis))
    return (axis + first + second) / 3 - SIGN[side] * edge / np.sqrt(6.0) * normal
