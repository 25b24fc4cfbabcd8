"""Whole-model inverse kinematics: the coordinates of a subject with fixed segment lengths that fit all markers best.

All frames at once: minimise over q(t)

    sum_t sum_k w_k |x_k(q_t) - y_kt|^2  +  sum_i lambda_i sum_t (d2 q_i / dt2)^2
        +  r^2 sum_t |angles(q_t) - angles(start_t)|^2  +  limit penalty

by Gauss-Newton with Levenberg's damping; the normal equations are banded. lambda_i is the mean diagonal of the
Gauss-Newton matrix divided by (2 pi f_c)^4, which makes the fit a zero-lag low-pass filter with gain
1 / (1 + (f / f_c)^4), that of a second-order Butterworth filter run forth and back at the cut-off f_c, but with the
markers' distances as its input. Missing markers have no weight, so short gaps are bridged by smoothness. The third term
(r = `prior_lever`) decides only what markers hardly see, such as the foot's roll with one heel and one toe marker.
Markers far from the model in single frames (swapped labels) are left out, and the fit repeated.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from gaitlab.errors import InvalidRecording
from gaitlab.inverse.kinematics_settings import InverseKinematicsSettings
from gaitlab.inverse.marker_consistency import distant_markers, inconsistent_markers
from gaitlab.inverse.marker_fit import FitProblem, minimise
from gaitlab.inverse.marker_moments import marker_moments
from gaitlab.multibody.kinematics import euler_angles, point_positions, unwrapped
from gaitlab.multibody.subject import PointOnSegment, SubjectModel
from gaitlab.signal.runs import runs, valid_rows

SLACK = 0.01
"""A coordinate counts as beyond its range from here [m, rad]."""

REPEATS = 2
"""How often the fit is repeated without markers that turned out to be far away."""

CENTRES = {"hip": "thigh", "knee": "shank", "ankle": "foot"}
"""A joint's centre is the origin of the segment that it carries."""


@dataclass(frozen=True, kw_only=True)
class InverseKinematics:
    """Coordinates of one trial, and how well they fit."""

    q: np.ndarray
    """Coordinates [m, rad], shape (n, n_q); NaN in frames that are not known."""
    residuals: Mapping[str, np.ndarray]
    """Marker name to the distance between model and measurement [m], shape (n,); NaN where missing."""
    marker_rms: float
    """Root mean square distance over all markers and frames but the left out ones [m]."""
    left_out: Mapping[str, int]
    """Marker name to the number of frames in which it was seen but not used: labels swapped, or marker moved."""
    known: np.ndarray
    """Frames with coordinates, shape (n,), bool: every segment is seen, or was not for `longest_gap` at most."""
    at_limits: tuple[str, ...]
    """Coordinates that lie outside their range in some frame, such as `left_shank_x`."""
    iterations: int
    converged: bool

    def rms_by_marker(self) -> dict[str, float]:
        """Root mean square distance of each marker that was seen at all [m]."""
        seen = {name: r[np.isfinite(r)] for name, r in self.residuals.items()}
        return {name: float(np.sqrt(np.mean(r**2))) for name, r in seen.items() if len(r)}


def solve_inverse_kinematics(
    subject: SubjectModel,
    markers: Mapping[str, np.ndarray],
    rate: float,
    settings: InverseKinematicsSettings | None = None,
    joint_centres: Mapping[str, np.ndarray] | None = None,
    initial: np.ndarray | None = None,
) -> InverseKinematics:
    """Coordinates that bring the subject's markers closest to the measured ones.

    Args:
        subject: model with markers.
        markers: name to positions in the gait frame [m], shape (n, 3), NaN where missing; unknown names are ignored.
        rate: frames per second [Hz].
        settings: weights and limits.
        joint_centres: `left_hip`, `right_knee` ... to positions that pull the model's joints, gait frame [m], (n, 3).
        initial: coordinates to start from, shape (n, n_q), NaN where unknown; for instance of the direct model.

    Raises:
        InvalidRecording: no frame has a marker of the subject, or `initial` is missing and the root has too few.
    """
    settings = settings or InverseKinematicsSettings()
    used = _usable(subject, markers, settings, initial)
    known = _known_frames(subject, used, round(settings.longest_gap * rate))
    q = np.full((len(known), subject.n_q), np.nan)
    iterations, converged = 0, True
    centres = joint_centres or {}
    for first, end in runs(known):
        own = slice(first, end)
        trial = _Trial(
            subject=subject,
            markers={name: y[own] for name, y in used.items()},
            joint_centres={name: y[own] for name, y in centres.items()},
            rate=rate,
            settings=settings,
        )
        fit = _fit_trial(trial, None if initial is None else initial[own])
        q[own], iterations, converged = fit.q, max(iterations, fit.iterations), converged and fit.converged
        for name, y in fit.used.items():
            used[name][own] = y
    return _result(subject, markers, used, _Fit(q=q, used=used, iterations=iterations, converged=converged), settings)


def _result(
    subject: SubjectModel,
    markers: Mapping[str, np.ndarray],
    used: Mapping[str, np.ndarray],
    fit: "_Fit",
    settings: InverseKinematicsSettings,
) -> InverseKinematics:
    lower, upper = settings.limits(subject)
    known = valid_rows(fit.q)
    outside = np.logical_or.reduce((fit.q < lower - SLACK) | (fit.q > upper + SLACK), axis=0)
    residuals = _residuals(subject, markers, fit.q)
    kept = [residuals[name][valid_rows(y)] for name, y in used.items()]
    squares = np.concatenate(kept) ** 2
    return InverseKinematics(
        q=fit.q,
        residuals=residuals,
        marker_rms=float(np.sqrt(np.nanmean(squares))),
        left_out=_count_left_out({name: np.where(known[:, None], markers[name], np.nan) for name in used}, used),
        known=known,
        at_limits=tuple(name for name, out in zip(coordinate_names(subject), outside, strict=True) if out),
        iterations=fit.iterations,
        converged=fit.converged,
    )


def _count_left_out(markers: Mapping[str, np.ndarray], used: Mapping[str, np.ndarray]) -> dict[str, int]:
    """Marker name to the number of frames where it is known in the first but not in the second mapping."""
    lost = {name: valid_rows(markers[name]) & ~valid_rows(used[name]) for name in used}
    return {name: int(frames.sum()) for name, frames in lost.items() if frames.any()}


def _usable(
    subject: SubjectModel,
    markers: Mapping[str, np.ndarray],
    settings: InverseKinematicsSettings,
    initial: np.ndarray | None,
) -> dict[str, np.ndarray]:
    """Copies of the measured markers that the model has, without those that cannot be on their segment."""
    swapped = inconsistent_markers(subject, markers, settings.distance_tolerance)
    if initial is not None:
        swapped += distant_markers(subject, markers, initial, settings.start_tolerance)
    used = {name: markers[name].copy() for name in subject.markers if name in markers}
    if not any(valid_rows(y).any() for name, y in used.items() if name not in swapped):
        known = ", ".join(sorted(subject.markers)) or "none"
        raise InvalidRecording(f"The trial has no marker that the subject's model knows; the model has: {known}.")
    for name in swapped:
        used[name][:] = np.nan
    return used


def _known_frames(subject: SubjectModel, used: Mapping[str, np.ndarray], longest: int) -> np.ndarray:
    """Frames in which all segments are seen, or were not for at most `longest` frames, shape (n,).

    The root is seen with three markers, others with two, or with as many as the model has at all.
    """
    n, n_segments = len(next(iter(used.values()))), len(subject.segments)
    counts, most = np.zeros((n, n_segments), dtype=int), np.zeros(n_segments, dtype=int)
    for name, y in used.items():
        segment, seen = subject.markers[name].segment, valid_rows(y)
        counts[:, segment] += seen
        most[segment] += bool(seen.any())
    wanted = np.minimum(np.array([3] + [2] * (n_segments - 1)), most)
    known: np.ndarray = np.logical_and.reduce(counts >= wanted, axis=1)
    for first, end in runs(~known):
        if end - first <= longest and first > 0 and end < n:
            known[first:end] = True
    if not known.any():
        unseen = ", ".join(
            s.name for s, full in zip(subject.segments, (counts >= wanted).T, strict=True) if not full.any()
        )
        raise InvalidRecording(
            "No frame shows enough markers of every segment (three on the pelvis, two on the others); "
            f"never seen: {unseen or 'all at once'}. Check the labels or fill the gaps."
        )
    return known


def coordinate_names(subject: SubjectModel) -> list[str]:
    """pelvis_tx, pelvis_ty, pelvis_tz, pelvis_y, pelvis_x, pelvis_z, right_thigh_y ..."""
    names = [f"{subject.segments[0].name}_t{axis}" for axis in "xyz"]
    return names + [f"{segment.name}_{axis}" for segment in subject.segments for axis in "yxz"]


@dataclass(frozen=True, kw_only=True)
class _Trial:
    """One stretch of frames, and what to do with it."""

    subject: SubjectModel
    markers: Mapping[str, np.ndarray]
    """Positions [m], shapes (n, 3)."""
    joint_centres: Mapping[str, np.ndarray]
    """Positions [m], shapes (n, 3)."""
    rate: float
    settings: InverseKinematicsSettings


@dataclass(frozen=True, kw_only=True)
class _Fit:
    q: np.ndarray
    """Coordinates, shape (n, n_q)."""
    used: Mapping[str, np.ndarray]
    """Markers [m], shapes (n, 3), NaN where left out."""
    iterations: int
    converged: bool


def _fit_trial(trial: _Trial, initial: np.ndarray | None) -> _Fit:
    """Fit, and again without the markers that turn out to be far away."""
    settings = trial.settings
    if initial is None:
        rough = replace(trial, settings=replace(settings, cut_off=0.0))
        start = _fit_once(rough, _initial_coordinates(trial.subject, trial.markers)).q
        start[:, 3:] = unwrapped(start[:, 3:])
    else:
        start = _without_gaps(initial)
    fit, far = _fit_once(trial, start), np.zeros(0)
    for _ in range(REPEATS):
        distances = _residuals(trial.subject, trial.markers, fit.q)
        before, far = far, np.array([distances[name] > settings.outlier for name in trial.markers])
        if np.array_equal(far, before) or not (far.any() or before.any()):
            break
        kept = {
            name: np.where(left_out[:, None], np.nan, y)
            for left_out, (name, y) in zip(far, trial.markers.items(), strict=True)
        }
        again = _fit_once(replace(trial, markers=kept), start)
        fit = replace(again, iterations=fit.iterations + again.iterations)
    return fit


def _fit_once(trial: _Trial, start: np.ndarray) -> _Fit:
    """One least-squares fit."""
    subject, settings = trial.subject, trial.settings
    points, targets, weights = dict(subject.markers), dict(trial.markers), dict(settings.marker_weights)
    segments = [segment.name for segment in subject.segments]
    for name, positions in trial.joint_centres.items():
        side, _, joint = name.partition("_")
        segment = segments.index(f"{side}_{CENTRES[joint]}")
        points[f"{name}_centre"] = PointOnSegment(segment=segment, position=np.zeros(3))
        targets[f"{name}_centre"] = positions
        weights[f"{name}_centre"] = settings.joint_centre_weight
    moments = marker_moments(subject, points, targets, weights)
    problem = FitProblem(subject=subject, moments=moments, rate=trial.rate, settings=settings, start=start)
    fit = minimise(problem)
    return _Fit(q=fit.q, used=trial.markers, iterations=fit.iterations, converged=fit.converged)


def _initial_coordinates(subject: SubjectModel, markers: Mapping[str, np.ndarray]) -> np.ndarray:
    """Root from the best rigid fit of its own markers, all joints at zero."""
    own = {name: point for name, point in subject.markers.items() if point.segment == 0 and name in markers}
    if len(own) < 3:
        names = ", ".join(own) or "none"
        raise InvalidRecording(f"Three markers are needed on the {subject.segments[0].name}; the trial has: {names}.")
    y = np.stack([markers[name] for name in own], axis=1)
    whole = np.isfinite(y).all(axis=(1, 2))
    if not whole.any():
        raise InvalidRecording(f"No frame shows {', '.join(own)} together; fill their gaps or choose another trial.")
    p = np.array([point.position for point in own.values()])
    q = np.full((len(y), subject.n_q), np.nan)
    q[whole] = 0.0
    cross = np.swapaxes(y[whole] - y[whole].mean(axis=1, keepdims=True), 1, 2) @ (p - p.mean(axis=0))
    U, _, Vt = np.linalg.svd(cross)
    U[:, :, 2] *= np.linalg.det(U @ Vt)[:, None]
    rotations = U @ Vt
    q[whole, :3] = y[whole].mean(axis=1) - rotations @ p.mean(axis=0) - subject.segments[0].joint_offset
    q[whole, 3:6] = euler_angles(rotations) - subject.segments[0].rotation_offset
    return _without_gaps(q)


def _without_gaps(q: np.ndarray) -> np.ndarray:
    """Coordinates with unknown frames interpolated, constant before the first and after the last known one."""
    frames, result = np.arange(len(q)), q.copy()
    result[:, 3:] = unwrapped(result[:, 3:])
    if np.isfinite(result).all():
        return result
    for column in result.T:
        known = np.isfinite(column)
        column[~known] = np.interp(frames[~known], frames[known], column[known]) if known.any() else 0.0
    return result


def _residuals(subject: SubjectModel, markers: Mapping[str, np.ndarray], q: np.ndarray) -> dict[str, np.ndarray]:
    """Distance between model and measurement of each marker [m], shapes (n,)."""
    seen = {name: point for name, point in subject.markers.items() if name in markers}
    positions = point_positions(subject, seen, q)
    return {name: np.linalg.norm(positions[name] - markers[name], axis=1) for name in seen}
