"""Two ways of walking, described by a few textbook numbers: what the demo recordings start from.

All curves are this project's own: smooth periodic curves through a handful of key points, with the ranges that any
textbook of gait analysis gives (for instance Perry and Burnfield 2010, Gait Analysis; Gage et al. 2009, The
Identification and Treatment of Gait Problems in Cerebral Palsy).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from ..mocap.recording import Side
from ..multibody.presets import thesis_able_bodied_child, thesis_cp_child
from ..multibody.subject import SubjectModel

SIDES: tuple[Side, Side] = ("right", "left")
SIGN: Mapping[Side, float] = {"right": -1.0, "left": 1.0}
"""+1 where the body's left-pointing y axis is lateral."""

Keys = tuple[tuple[float, float], ...]
"""Key points (share of the cycle, angle [deg])."""


GRID = 0.02
"""All changes of contact lie on multiples of this time [s], the interval of the estimator's grid."""


@dataclass(frozen=True, kw_only=True)
class ContactTimes:
    """When heel and toe touch the floor [s] after the foot strike of their side."""

    heel: tuple[float, float]
    toe: tuple[float, float]

    @property
    def stance(self) -> float:
        """Time of foot off [s]."""
        return max(self.heel[1], self.toe[1])

    def prolonged(self, time: float) -> "ContactTimes":
        """Later ends of the contacts by a time [s]; with half a stride's change double support stays as it is."""
        return ContactTimes(heel=(self.heel[0], self.heel[1] + time), toe=(self.toe[0], self.toe[1] + time))


@dataclass(frozen=True, kw_only=True)
class GaitPattern:
    """One child's way of walking."""

    name: str
    preset: Callable[[], SubjectModel]
    stride_time: float
    """[s]"""
    speed: float
    """[m/s]"""
    contacts: Mapping[Side, ContactTimes]
    curves: Mapping[str, Keys]
    """hip_flexion, hip_adduction, hip_rotation, knee_flexion, ankle_dorsiflexion of the own side; pelvis_tilt,
    pelvis_obliquity, pelvis_rotation of the right side; clinical signs."""
    standing: Mapping[str, float]
    """Angles in the static trial [deg]."""
    tilt: float
    """Clinical anterior tilt of the pelvis whose model axes are upright [rad]: ASIS lie lower than PSIS."""
    half_width: float
    """Lateral distance of a foot from the line of progression [m]."""
    sway: float
    """Lateral amplitude of the pelvis [m]."""
    rise: float
    """Vertical amplitude of the pelvis [m]."""
    clearance: float
    """Height that heel and toe reach at least in the middle of swing [m]."""

    def curve(self, name: str, phase: np.ndarray) -> np.ndarray:
        """The periodic cubic spline through the key points of a curve at shares of the cycle (n,) [rad], shape (n,)."""
        x, y = np.array(self.curves[name]).T
        spline = CubicSpline(np.append(x, x[0] + 1.0), np.append(y, y[0]), bc_type="periodic")
        return np.radians(spline(x[0] + (phase - x[0]) % 1.0))

    def delay(self, side: Side) -> float:
        """Foot strike of a side [s] after that of the right side."""
        return 0.0 if side == "right" else self.stride_time / 2

    def paced(self, stride_time: float, speed: float) -> "GaitPattern":
        """The pattern with another stride time [s] and speed [m/s]; the time of double support stays."""
        longer = (stride_time - self.stride_time) / 2
        contacts = {side: times.prolonged(longer) for side, times in self.contacts.items()}
        return replace(self, stride_time=stride_time, speed=speed, contacts=contacts)


def demo_patterns() -> tuple[GaitPattern, GaitPattern]:
    """The child with cerebral palsy and the able-bodied child, in the order of their folders."""
    return CP_CHILD, ABLE_BODIED_CHILD


ABLE_BODIED_CHILD = GaitPattern(
    name="demo_able_bodied_child",
    preset=thesis_able_bodied_child,
    stride_time=1.04,
    speed=1.10,
    contacts={side: ContactTimes(heel=(0.0, 0.42), toe=(0.08, 0.64)) for side in SIDES},
    curves={
        "hip_flexion": ((0.0, 30.0), (0.12, 25.0), (0.3, 8.0), (0.5, -9.0), (0.62, 0.0), (0.85, 33.0)),
        "hip_adduction": ((0.0, 0.0), (0.2, 5.0), (0.45, 3.0), (0.65, -5.0), (0.85, -2.0)),
        "hip_rotation": ((0.0, -2.0), (0.25, 2.0), (0.5, 3.0), (0.75, -3.0)),
        "knee_flexion": ((0.0, 6.0), (0.14, 18.0), (0.38, 6.0), (0.6, 37.0), (0.73, 60.0), (0.94, 5.0)),
        "ankle_dorsiflexion": ((0.0, 0.0), (0.07, -5.0), (0.44, 11.0), (0.62, -15.0), (0.78, 0.0), (0.92, 1.0)),
        "pelvis_tilt": ((0.0, 10.0), (0.25, 9.0), (0.5, 10.0), (0.75, 9.0)),
        "pelvis_obliquity": ((0.0, 1.0), (0.16, 4.0), (0.5, -1.0), (0.66, -4.0)),
        "pelvis_rotation": ((0.0, 5.0), (0.25, 0.0), (0.5, -5.0), (0.75, 0.0)),
    },
    standing={"pelvis_tilt": 10.0, "hip_flexion": 10.0, "knee_flexion": 2.0},
    tilt=np.radians(10.0),
    half_width=0.055,
    sway=0.018,
    rise=0.015,
    clearance=0.012,
)

CP_CHILD = GaitPattern(
    name="demo_cp_child",
    preset=thesis_cp_child,
    stride_time=1.20,
    speed=0.78,
    contacts={
        "right": ContactTimes(heel=(0.08, 0.56), toe=(0.0, 0.80)),
        "left": ContactTimes(heel=(0.06, 0.52), toe=(0.0, 0.80)),
    },
    curves={
        "hip_flexion": ((0.0, 46.0), (0.15, 41.0), (0.35, 26.0), (0.54, 14.0), (0.66, 22.0), (0.87, 47.0)),
        "hip_adduction": ((0.0, 5.0), (0.2, 9.0), (0.45, 7.0), (0.65, 0.0), (0.85, 2.0)),
        "hip_rotation": ((0.0, 17.0), (0.3, 14.0), (0.55, 16.0), (0.8, 12.0)),
        "knee_flexion": ((0.0, 36.0), (0.14, 35.0), (0.42, 24.0), (0.62, 40.0), (0.76, 52.0), (0.92, 39.0)),
        "ankle_dorsiflexion": ((0.0, -5.0), (0.08, 1.0), (0.4, 9.0), (0.64, -14.0), (0.8, -4.0), (0.93, -7.0)),
        "pelvis_tilt": ((0.0, 19.0), (0.25, 17.0), (0.5, 19.0), (0.75, 17.0)),
        "pelvis_obliquity": ((0.0, 1.0), (0.18, 5.0), (0.5, -1.0), (0.68, -5.0)),
        "pelvis_rotation": ((0.0, 7.0), (0.25, 0.0), (0.5, -7.0), (0.75, 0.0)),
    },
    standing={"pelvis_tilt": 17.0, "hip_flexion": 30.0, "hip_rotation": 12.0, "knee_flexion": 25.0},
    tilt=np.radians(15.0),
    half_width=0.065,
    sway=0.025,
    rise=0.012,
    clearance=0.010,
)
