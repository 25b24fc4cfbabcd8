"""From the direct conventional gait model to the person's multibody model and its motion."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..errors import InvalidSubject
from ..inverse.conventional import ConventionalKinematics
from ..inverse.kinematics import InverseKinematics, solve_inverse_kinematics
from ..inverse.kinematics_settings import InverseKinematicsSettings
from ..inverse.marker_fit import marker_information
from ..mocap.recording import Recording
from ..multibody.kinematics import coordinates_from_poses
from ..multibody.scaling import MeasuredBody, SubjectSettings, build_subject, segment_poses
from ..multibody.subject import SubjectModel
from ..walking.joint_search import MeasuredFrames
from .gait_frame import lab_to_gait, rotation_gait_to_lab

UNSMOOTHED = InverseKinematicsSettings(cut_off=0.0, prior_lever=0.002, tolerance=1e-6)
LEAST_NOISE = 2e-5
"""Of a marker's coordinate [m]: what rounding leaves."""
ACCELERATION = 50.0
"""Of the coordinates [rad/s^2], order of magnitude."""
SEGMENTS = ("pelvis", *(f"{side}_{kind}" for side in ("right", "left") for kind in ("thigh", "shank", "foot")))


def person_model(
    recording: Recording,
    kinematics: ConventionalKinematics,
    parameters: Mapping[str, float],
    settings: SubjectSettings,
) -> SubjectModel:
    """The person's model from a static trial, or from a walk where there is none."""
    missing = [name for name in ("mass", "height") if name not in parameters]
    if missing:
        options = " and ".join(f"--{name}" for name in missing)
        raise InvalidSubject(
            f"{recording.name}: the file does not hold the body's {' and '.join(missing)}; use {options}"
        )
    body = _measured_body(recording, kinematics, 0.0)
    return build_subject(body, parameters["mass"], parameters["height"], settings=settings)


def whole_model_motion(
    subject: SubjectModel, recording: Recording, kinematics: ConventionalKinematics
) -> InverseKinematics:
    """Least-squares motion of the model over all markers, gait frame, started from the direct model."""
    body = _measured_body(recording, kinematics, kinematics.heading)
    poses = segment_poses(body)
    rotations = [poses[segment.name if segment.name in poses else "pelvis"].rotation for segment in subject.segments]
    start = coordinates_from_poses(subject, poses["pelvis"].origin, np.stack(rotations, axis=1))
    return solve_inverse_kinematics(
        subject, body.markers, recording.rate, joint_centres=body.joint_centres, initial=start
    )


def single_frames(
    subject: SubjectModel, recording: Recording, heading: float, motion: InverseKinematics
) -> MeasuredFrames:
    """Coordinates that the markers of each frame alone tell, for estimates that want white noise.

    From the smoothed motion, which tells which turn of an angle is meant.
    """
    markers = {name: lab_to_gait(positions, heading) for name, positions in recording.markers.items()}
    alone = solve_inverse_kinematics(subject, markers, recording.rate, UNSMOOTHED, initial=motion.q)
    noise = max(marker_noise(alone, subject.n_q), LEAST_NOISE)
    smoothing = replace(UNSMOOTHED, agility=noise / ACCELERATION)
    smoothed = solve_inverse_kinematics(subject, markers, recording.rate, smoothing, initial=motion.q)
    information = marker_information(subject, markers, np.where(np.isfinite(alone.q), alone.q, 0.0))
    return MeasuredFrames(
        times=np.arange(len(alone.q)) / recording.rate,
        q=alone.q,
        little_smoothed=smoothed.q,
        information=information,
        noise=noise,
    )


def marker_noise(alone: InverseKinematics, n_q: int) -> float:
    """Standard deviation of a marker's coordinate [m] from the misfit of frames that are fitted one by one."""
    squares = np.concatenate([distances[np.isfinite(distances)] ** 2 for distances in alone.residuals.values()])
    freedom = 3 * len(squares) - n_q * int(alone.known.sum())
    return float(np.sqrt(squares.sum() / max(freedom, 1)))


def motion_warnings(motion: InverseKinematics) -> tuple[str, ...]:
    """What a reader should know about the fit of the whole model, one sentence each."""
    warnings: list[str] = []
    if motion.left_out:
        markers = ", ".join(f"{name} in {frames} frames" for name, frames in sorted(motion.left_out.items()))
        warnings.append(f"left out of the whole-model kinematics, as they cannot be on their segment: {markers}")
    if motion.at_limits:
        warnings.append(f"coordinates of the model beyond their usual range: {', '.join(motion.at_limits)}")
    if not motion.converged:
        warnings.append("the whole-model kinematics stopped before it converged; look at its marker residual")
    return tuple(warnings)


def _measured_body(recording: Recording, kinematics: ConventionalKinematics, heading: float) -> MeasuredBody:
    """What was measured, turned from the laboratory to the gait frame of a heading [rad]."""
    to_gait = rotation_gait_to_lab(heading).T
    return MeasuredBody(
        joint_centres={name: lab_to_gait(centre, heading) for name, centre in kinematics.joint_centres.items()},
        axes={name: to_gait @ kinematics.segments[name].rotation for name in SEGMENTS},
        markers={name: lab_to_gait(positions, heading) for name, positions in recording.markers.items()},
    )
