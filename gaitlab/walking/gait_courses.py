"""Curves and stick figures of a point-foot gait, for figures like 15.3 to 15.14 of Hatz (2014)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..multibody.kinematics import forward_kinematics, point_positions
from ..transcription.hermite import GAUSS_POINTS
from .gait_data import PointFootGait
from .model import ROOT
from .point_foot_gait import GaitOptimum


@dataclass(frozen=True, kw_only=True)
class GaitCourses:
    """Curves of one model; one array per stage, because velocities and torques jump between stages."""

    times: Sequence[np.ndarray]
    """Nodes [s], shapes (N_k + 1,)."""
    measured: Sequence[np.ndarray]
    """Coordinates [m, rad], shapes (N_k + 1, 24)."""
    states: Sequence[np.ndarray]
    """Optimal states, shapes (N_k + 1, 48)."""
    torque_times: Sequence[np.ndarray]
    """Gauss points [s], shapes (2 N_k,)."""
    torques: Sequence[np.ndarray]
    """Joint torques [N*m], shapes (2 N_k, 18)."""
    joints: Sequence[np.ndarray]
    """Chains of joint centres of the optimal gait [m], shapes (n_postures, n_points, 3)."""
    measured_joints: Sequence[np.ndarray]
    """The same of the measured gait [m], shapes (n_postures, n_points, 3)."""


def courses(optimum: GaitOptimum) -> GaitCourses:
    """Curves and stick figures of an optimal gait and of the measurements that its level has."""
    level, gait, n_q = optimum.level, optimum.level.gait, optimum.level.n_q
    begins = np.cumsum([0.0, *gait.durations[:-1]])
    sizes = list(zip(begins, gait.durations, gait.n_intervals, strict=True))
    points = [t0 + d * (np.arange(n)[:, None] + GAUSS_POINTS).ravel() / n for t0, d, n in sizes]
    pairs = zip(optimum.problems, optimum.solutions, strict=True)
    return GaitCourses(
        times=[t0 + np.linspace(0.0, d, n + 1) for t0, d, n in sizes],
        measured=level.measured.q,
        states=optimum.states,
        torque_times=points,
        torques=[problem.outputs(x.w)[:, ROOT:n_q] for problem, x in pairs],
        joints=_sticks(gait, [x[:, :n_q] for x in optimum.states]),
        measured_joints=_sticks(gait, level.measured.q),
    )


def _sticks(gait: PointFootGait, coordinates: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Chains toe-ankle-knee-hip-pelvis of both sides in some postures [m], shapes (n, 5, 3)."""
    q = np.concatenate([each[:: max(1, len(each) // 4)] for each in coordinates])
    origins = forward_kinematics(gait.subject, q).origins
    toes = point_positions(gait.subject, gait.subject.contacts, q)
    return [
        np.stack([toes[f"{side}_toe"], *(origins[:, i] for i in (first + 2, first + 1, first, 0))], axis=1)
        for side, first in (("right", 1), ("left", 4))
    ]
