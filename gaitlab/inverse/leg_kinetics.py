"""Clinical kinetics: moments, powers and ground reactions of both legs, wherever the ground reaction is known."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gaitlab.inverse.conventional import ConventionalKinematics
from gaitlab.inverse.conventional_calibration import SIDES, SIGN
from gaitlab.inverse.conventional_geometry import cross, unit
from gaitlab.inverse.dynamics import Bodies, JointLoad, Wrench, leg_loads
from gaitlab.inverse.measured_body import laboratory_to_gait, measured_body
from gaitlab.inverse.published_inertia import published_bodies
from gaitlab.mocap.force_plates import at_video_frames, centre_of_pressure, free_moment
from gaitlab.mocap.plate_assignment import PlateContact
from gaitlab.mocap.recording import Event, Recording, Side
from gaitlab.multibody.rigid_body import RigidBody
from gaitlab.multibody.scaling import SegmentPose, segment_poses
from gaitlab.multibody.subject import SubjectModel
from gaitlab.signal.filtering import low_pass

MomentFrame = Literal["distal", "proximal", "joint", "laboratory"]
InertiaConvention = Literal["subject", "plug-in gait"]

STANDARD_GRAVITY = 9.81  # m/s^2, as in the dynamics
PRESSURE = 20.0  # N; below it there is no centre of pressure
JOINTS = {"hip": ("pelvis", "thigh"), "knee": ("thigh", "shank"), "ankle": ("shank_torsioned", "foot")}
"""Joint to the segments above and below it, by the names of `ConventionalKinematics.segments`."""
MOMENTS = {
    "hip_extensor_moment": ("hip", 1, 1.0, False),
    "hip_abductor_moment": ("hip", 0, 1.0, True),
    "hip_external_rotator_moment": ("hip", 2, 1.0, True),
    "knee_extensor_moment": ("knee", 1, -1.0, False),
    "knee_abductor_moment": ("knee", 0, 1.0, True),
    "knee_external_rotator_moment": ("knee", 2, 1.0, True),
    "ankle_plantarflexor_moment": ("ankle", 1, 1.0, False),
    "ankle_evertor_moment": ("ankle", 0, 1.0, True),
    "ankle_external_rotator_moment": ("ankle", 2, 1.0, True),
}
"""Internal moments: joint, axis (0 forward, 1 left, 2 up), sign on the left, whether the right leg is mirrored."""
POWERS = {f"{joint}_power": joint for joint in JOINTS}
REACTIONS = ("ground_reaction_vertical", "ground_reaction_forward", "ground_reaction_medial")


@dataclass(frozen=True, kw_only=True)
class KineticsSettings:
    """Choices of the inverse dynamics."""

    frame: MomentFrame = "distal"
    """Axes that moments are expressed in. Distal or proximal: those of the segment below or above the joint. Joint:
    projected onto the joint coordinate system, that is the flexion axis of the proximal segment, the long axis of the
    distal one and the axis across both. Laboratory: forward, left and up."""
    inertia: InertiaConvention = "subject"
    """Subject: the model's segments. Plug-in Gait: numbers as Vicon applies them, to explain differences."""
    cut_off: float = 0.0
    """Low-pass of joint centres and axes [Hz]; 0: as the file's markers are, which capture software has smoothed."""


@dataclass(frozen=True, kw_only=True)
class Kinetics:
    """Kinetics of one trial, NaN where the ground reaction of the foot is not known."""

    contacts: tuple[PlateContact, ...]
    curves: Mapping[str, np.ndarray]
    """left_hip_extensor_moment ... [N*m/kg], left_hip_power ... [W/kg], left_ground_reaction_vertical ... [% of body
    weight], shape (n,). Moments are internal: those that the muscles exert."""
    pressure: Mapping[Side, np.ndarray]
    """Centre of pressure under each foot, laboratory frame [m], shape (n, 3); NaN without an accepted contact."""
    free_moment: Mapping[Side, np.ndarray]
    """About the plate's normal at the centre of pressure [N*m/kg], shape (n,)."""
    settings: KineticsSettings


def solve_kinetics(
    recording: Recording,
    kinematics: ConventionalKinematics,
    subject: SubjectModel,
    steps: tuple[Sequence[PlateContact], Sequence[Event]],
    settings: KineticsSettings | None = None,
) -> Kinetics:
    """Moments and powers of hip, knee and ankle, and ground reactions, per video frame.

    Args:
        recording: The trial, plates included.
        kinematics: Its joint centres and segment axes, laboratory frame.
        subject: Mass properties.
        steps: The assigned contacts, and the events that tell when a foot is in the air.
        settings: Choices.
    """
    settings = settings or KineticsSettings()
    found, events = steps
    poses = _smoothed(segment_poses(measured_body(recording, kinematics)), recording.rate, settings.cut_off)
    bodies = _bodies(subject, poses, settings.inertia)
    curves: dict[str, np.ndarray] = {}
    pressure: dict[Side, np.ndarray] = {}
    free_moment: dict[Side, np.ndarray] = {}
    for side in SIDES:
        ground, pressure[side], twist = ground_reaction(recording, found, side)
        known = ground_is_known(recording, found, events, side)
        ground = Wrench(point=ground.point, force=_masked(ground.force, known), moment=_masked(ground.moment, known))
        loads = leg_loads(side, poses, bodies, ground, recording.rate)
        curves |= _moment_curves(side, loads, kinematics, settings.frame, subject.mass)
        curves |= {f"{side}_{name}": loads[joint].power / subject.mass for name, joint in POWERS.items()}
        curves |= _reaction_curves(side, ground.force, kinematics.forward, subject.mass)
        free_moment[side] = twist / subject.mass
    return Kinetics(contacts=tuple(found), curves=curves, pressure=pressure, free_moment=free_moment, settings=settings)


def ground_reaction(
    recording: Recording, found: Sequence[PlateContact], side: Side
) -> tuple[Wrench, np.ndarray, np.ndarray]:
    """What the ground exerts on a foot through accepted contacts, at video frames; zero outside of them.

    Returns:
        The wrench about the laboratory's origin [N, N*m]; the centre of pressure [m], shape (n, 3); the free moment
        [N*m], shape (n,), see `force_plates.free_moment`. Both NaN without load.
    """
    n = recording.n_frames
    force, moment = np.zeros((n, 3)), np.zeros((n, 3))
    pressure, twist = np.full((n, 3), np.nan), np.full(n, np.nan)
    for contact in found:
        if contact.side != side or not contact.accepted:
            continue
        plate = at_video_frames(recording.force_plates[contact.plate], recording.rate, n)
        frames = slice(int(contact.start * recording.rate), min(int(np.ceil(contact.end * recording.rate)) + 1, n))
        middle = plate.corners.mean(axis=0)
        F, M = plate.force[frames], plate.moment[frames]
        whole = centre_of_pressure(plate, PRESSURE)
        force[frames] += F
        moment[frames] += M + np.cross(middle, F)
        pressure[frames] = whole[frames]
        twist[frames] = free_moment(plate, whole)[frames]
    return Wrench(point=np.zeros((n, 3)), force=force, moment=moment), pressure, twist


def ground_is_known(
    recording: Recording, found: Sequence[PlateContact], events: Sequence[Event], side: Side
) -> np.ndarray:
    """Whether the ground reaction of a foot is known in each frame, shape (n,): in accepted contacts and in swing.

    A stance is known as a whole when an accepted contact is its own, times in [s]; without events there is no swing.
    """
    time = np.arange(recording.n_frames) / recording.rate
    known = np.zeros(recording.n_frames, dtype=bool)
    accepted = [c for c in found if c.side == side and c.accepted]
    for contact in accepted:
        known |= (time >= contact.start - 1.0 / recording.rate) & (time <= contact.end + 1.0 / recording.rate)
    own = sorted((event for event in events if event.side == side), key=lambda event: event.time)
    for first, last in zip([None, *own], [*own, None], strict=True):
        start = -np.inf if first is None else first.time - 1e-9
        end = np.inf if last is None else last.time + 1e-9
        swing = (first is None or first.kind == "foot_off") and (last is None or last.kind == "foot_strike")
        stance = not swing and any(start <= (c.start + c.end) / 2 <= end for c in accepted)
        if own and (swing or (stance and first is not None and last is not None)):
            known |= (time >= start) & (time <= end)
    return known


def _masked(values: np.ndarray, known: np.ndarray) -> np.ndarray:
    return np.where(known[:, None], values, np.nan)


def _smoothed(poses: Mapping[str, SegmentPose], rate: float, cut_off: float) -> dict[str, SegmentPose]:
    """Poses with filtered origins and axes, the axes made orthonormal again by the nearest rotation."""
    if cut_off <= 0.0:
        return dict(poses)
    smooth: dict[str, SegmentPose] = {}
    for name, pose in poses.items():
        axes = low_pass(pose.rotation.reshape(-1, 9), rate, cut_off).reshape(-1, 3, 3)
        seen = np.isfinite(axes).all(axis=(1, 2))
        left, _, right = np.linalg.svd(axes[seen])
        axes[seen] = left @ right
        smooth[name] = SegmentPose(origin=low_pass(pose.origin, rate, cut_off), rotation=axes)
    return smooth


def _bodies(subject: SubjectModel, poses: Mapping[str, SegmentPose], convention: InertiaConvention) -> Bodies:
    if convention == "plug-in gait":
        return published_bodies(subject, poses)
    return {
        s.name: RigidBody(mass=s.mass, centre_of_mass=s.centre_of_mass, inertia=s.inertia) for s in subject.segments
    }


def _moment_curves(
    side: Side, loads: Mapping[str, JointLoad], kinematics: ConventionalKinematics, frame: MomentFrame, mass: float
) -> dict[str, np.ndarray]:
    local = {
        joint: np.einsum("nij,ni->nj", moment_axes(side, joint, kinematics, frame), loads[joint].moment) / mass
        for joint in JOINTS
    }
    return {
        f"{side}_{name}": sign * (SIGN[side] if mirrored else 1.0) * local[joint][:, axis]
        for name, (joint, axis, sign, mirrored) in MOMENTS.items()
    }


def moment_axes(side: Side, joint: str, kinematics: ConventionalKinematics, frame: MomentFrame) -> np.ndarray:
    """Axes forward, left, up as columns onto which a joint's moment is projected, laboratory frame, shape (n, 3, 3)."""
    above, below = JOINTS[joint]
    proximal = kinematics.segments[above if above == "pelvis" else f"{side}_{above}"].rotation
    distal = kinematics.segments[f"{side}_{below}"].rotation
    if frame == "laboratory":
        return np.broadcast_to(laboratory_to_gait(kinematics.forward).T, distal.shape)
    if frame == "joint":
        flexion, long = proximal[:, :, 1], distal[:, :, 2]
        return np.stack([unit(cross(flexion, long)), flexion, long], axis=2)
    return proximal if frame == "proximal" else distal


def _reaction_curves(side: Side, force: np.ndarray, forward: float, mass: float) -> dict[str, np.ndarray]:
    gait = force @ laboratory_to_gait(forward).T * (100.0 / (mass * STANDARD_GRAVITY))
    values = (gait[:, 2], gait[:, 0], -SIGN[side] * gait[:, 1])
    return {f"{side}_{name}": value for name, value in zip(REACTIONS, values, strict=True)}
