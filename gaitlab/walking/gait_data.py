"""The thesis's gait models and their measurements as data."""

from dataclasses import dataclass, replace

import numpy as np

from ..multibody.subject import SubjectModel
from ..ocp.mechanical import ContactStage
from .contact_schedule import thesis_stages
from .tracking import N_FORCES


@dataclass(frozen=True, kw_only=True)
class PointFootGait:
    """One of the two models of the thesis with everything that its lower level needs."""

    name: str
    subject: SubjectModel
    durations: tuple[float, float, float]
    """Of the three single supports [s]."""
    n_intervals: tuple[int, int, int]
    states: np.ndarray
    """States (q, v) at both ends of each stage [m, rad, 1/s], shape (3, 2, 2 n_q)."""
    normalisers: np.ndarray
    """Means N_i of the criteria, summed over the stages, at the true optimum, shape (4,)."""
    acceleration_weight: float
    """Weight of half the squared angular accelerations, mean over each stage: joints without load stay calm."""
    torque_floor: float
    """Weight of the normalised squared torques beside criteria that sum to one."""
    force_weight: float
    """Weight of half the squared contact forces in body weights, mean over each stage."""

    @property
    def stages(self) -> tuple[ContactStage, ...]:
        """The three single supports; as in the thesis, nothing limits the forces of the floor."""
        free = np.zeros((0, N_FORCES))
        return tuple(replace(stage, force_cone=free) for stage in thesis_stages(self.durations, self.n_intervals))

    def finer(self, factor: int) -> "PointFootGait":
        """The same on a grid with `factor` times as many intervals."""
        first, second, third = self.n_intervals
        return replace(self, n_intervals=(factor * first, factor * second, factor * third))


@dataclass(frozen=True, kw_only=True)
class MeasuredGait:
    """Coordinates measured at the nodes."""

    q: tuple[np.ndarray, ...]
    """Per stage [m, rad], shapes (N_k + 1, n_q)."""
    deviation: np.ndarray
    """Standard deviations of the coordinates [m, rad], shape (n_q,)."""
