"""The subject as a Pinocchio model: the oracle of our dynamics, and the way into Pinocchio's tools."""

import numpy as np
import pinocchio as pin

from gaitlab.multibody.subject import Segment, SubjectModel

AXES = ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
"""Axes of the Y'X'Z' rotations."""


def to_pinocchio(subject: SubjectModel) -> pin.Model:
    """Pinocchio model with the same coordinates q and v = dq/dt, n_q = n_v.

    Every segment is one composite joint named after it (the root's starts with a translation). Contact points and
    markers are operational frames of their own names, with the segment's axes; gravity is 9.81 m/s^2 along -z.
    """
    model = pin.Model()
    model.name = subject.name
    model.gravity = pin.Motion(np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0]))
    joints: list[int] = []
    for segment in subject.segments:
        parent = 0 if segment.parent < 0 else joints[segment.parent]
        placement = pin.SE3(np.eye(3), segment.joint_offset)
        joints.append(model.addJoint(parent, _joint(segment), placement, segment.name))
        model.appendBodyToJoint(joints[-1], _inertia(segment), pin.SE3.Identity())
        model.addFrame(pin.Frame(segment.name, joints[-1], 0, pin.SE3.Identity(), pin.FrameType.BODY))
    for name, point in {**subject.contacts, **subject.markers}.items():
        placement = pin.SE3(np.eye(3), point.position)
        model.addFrame(pin.Frame(name, joints[point.segment], 0, placement, pin.FrameType.OP_FRAME))
    return model


def _joint(segment: Segment) -> pin.JointModelComposite:
    joint = pin.JointModelComposite()
    if segment.parent < 0:
        joint.addJoint(pin.JointModelTranslation())
    for axis, offset, kind in zip(
        AXES, segment.rotation_offset, (pin.JointModelRY, pin.JointModelRX, pin.JointModelRZ), strict=True
    ):
        turned = pin.AngleAxis(float(offset), np.array(axis)).toRotationMatrix()
        joint.addJoint(kind(), pin.SE3(turned, np.zeros(3)))
    return joint


def _inertia(segment: Segment) -> pin.Inertia:
    return pin.Inertia(segment.mass, segment.centre_of_mass, segment.inertia)
