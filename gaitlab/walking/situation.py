"""Body, task and weights for which a walk is predicted."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..multibody.dynamics import parameter_vector
from ..multibody.subject import SubjectModel
from ..transcription.output_limits import OutputLimit
from .model import ROOT

FAR = 100.0
"""Stands for no limit of a coordinate [m, rad]: finite, as slacks must be."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """What the walk has to do; two of the three at most are given, the others follow from the optimum."""

    speed: float | None = None
    """Mean speed [m/s]."""
    stride_length: float | None = None
    """[m]"""
    stride_time: float | None = None
    """[s]"""

    @property
    def frees_time(self) -> bool:
        """Whether the stride time is found by the optimisation."""
        return self.stride_time is None and (self.speed is None or self.stride_length is None)

    def fixed_time(self) -> float | None:
        """Stride time [s] that follows from the task; None where it is free."""
        if self.speed is not None and self.stride_length is not None:
            return self.stride_length / self.speed
        return self.stride_time

    def length(self, time: float) -> float:
        """Stride length [m] of a stride of this time [s]."""
        if self.stride_length is not None:
            return self.stride_length
        return (self.speed or 0.0) * time


@dataclass(frozen=True, kw_only=True)
class Situation:
    """A body, a task and weights; everything numeric may change along a continuation."""

    subject: SubjectModel
    task: Task
    springs: Mapping[int, tuple[float, float]]
    """Coordinate to stiffness [N*m/rad] and neutral angle [rad] of an orthosis."""
    lower: Mapping[int, float]
    """Coordinate to its lowest value [rad]."""
    upper: Mapping[int, float]
    """Coordinate to its highest value [rad]."""
    torques: Mapping[OutputLimit, float]
    """Joint torques that must not exceed a bound [N*m]."""
    weights: np.ndarray | None = None
    """Of the criteria, on the simplex, shape (n_criteria,); None: those that were identified."""

    def parameters(self) -> np.ndarray:
        """Parameters of the walking model (see `model.walking_model`), shape (n_p,)."""
        n_joint = self.subject.n_q - ROOT
        passive = np.zeros((3, n_joint))
        for coordinate, (stiffness, neutral) in self.springs.items():
            passive[[0, 2], coordinate - ROOT] = stiffness, neutral
        return np.concatenate([parameter_vector(self.subject), passive.ravel()])

    def ranges(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates [m, rad], far away where there is no limit, shapes (n_q,)."""
        low, high = np.full(self.subject.n_q, -FAR), np.full(self.subject.n_q, FAR)
        low[list(self.lower)], high[list(self.upper)] = list(self.lower.values()), list(self.upper.values())
        return low, high
