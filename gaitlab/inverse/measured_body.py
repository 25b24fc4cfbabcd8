"""From the direct model's results to what the whole model is built from and started at."""

import numpy as np

from gaitlab.inverse.conventional import ConventionalKinematics
from gaitlab.inverse.static_knee import knee_marker
from gaitlab.mocap.recording import Recording
from gaitlab.multibody.kinematics import coordinates_from_poses
from gaitlab.multibody.scaling import SIDES, MeasuredBody, segment_poses
from gaitlab.multibody.subject import SubjectModel


def measured_body(recording: Recording, kinematics: ConventionalKinematics) -> MeasuredBody:
    """Joint centres, axes and markers of a trial in the laboratory frame; a knee device gives the knee marker."""
    markers = dict(recording.markers)
    for side in SIDES:
        markers |= knee_marker(markers, side)
    axes = {name: segment.rotation for name, segment in kinematics.segments.items()}
    return MeasuredBody(joint_centres=kinematics.joint_centres, axes=axes, markers=markers)


def in_gait_frame(body: MeasuredBody, heading: float) -> MeasuredBody:
    """The same body with x along the heading [rad] about the vertical: gait = R_z(-heading) laboratory."""
    R = laboratory_to_gait(heading)
    return MeasuredBody(
        joint_centres={name: points @ R.T for name, points in body.joint_centres.items()},
        axes={name: R @ axes for name, axes in body.axes.items()},
        markers={name: points @ R.T for name, points in body.markers.items()},
    )


def laboratory_to_gait(heading: float) -> np.ndarray:
    """R_z(-heading) for a heading [rad], shape (3, 3)."""
    c, s = np.cos(heading), np.sin(heading)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def direct_coordinates(subject: SubjectModel, body: MeasuredBody) -> np.ndarray:
    """The subject's coordinates q (n, n_q) [m, rad] with the direct model's segment axes, body in the gait frame.

    NaN where the direct model has none; a trunk joint is at zero. Start of `solve_inverse_kinematics`.
    """
    poses = segment_poses(body)
    pelvis = poses["pelvis"]
    rotations = np.stack([poses.get(segment.name, pelvis).rotation for segment in subject.segments], axis=1)
    return coordinates_from_poses(subject, pelvis.origin, rotations)
