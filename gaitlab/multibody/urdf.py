"""The subject as URDF: chains of single-axis joints, readable by any robotics tool."""

from xml.etree import ElementTree

import numpy as np

from gaitlab.multibody.subject import Segment, SubjectModel

AXES = {"y": "0 1 0", "x": "1 0 0", "z": "0 0 1"}
LIMIT = {"lower": "-3.1415926535897931", "upper": "3.1415926535897931", "effort": "500", "velocity": "100"}
TRAVEL = {"lower": "-1000", "upper": "1000", "effort": "10000", "velocity": "100"}


def to_urdf(subject: SubjectModel) -> str:
    """URDF text of the subject: joints `<segment>_tx`, `_ty`, `_tz` (root only), `_y`, `_x`, `_z`.

    Lengths in m, masses in kg. The link of a segment has its name, links between the joints of one segment have no
    mass, contact points and markers are links `<name>` on fixed joints. World link: "world", the gait frame.
    """
    robot = ElementTree.Element("robot", name=subject.name)
    ElementTree.SubElement(robot, "link", name="world")
    for segment in subject.segments:
        parent = "world" if segment.parent < 0 else subject.segments[segment.parent].name
        _add_segment(robot, segment, parent)
    for name, point in {**subject.contacts, **subject.markers}.items():
        ElementTree.SubElement(robot, "link", name=name)
        joint = _add_joint(robot, f"{name}_fixed", "fixed", (subject.segments[point.segment].name, name))
        ElementTree.SubElement(joint, "origin", xyz=_numbers(point.position), rpy="0 0 0")
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode", xml_declaration=True) + "\n"


def _add_segment(robot: ElementTree.Element, segment: Segment, parent: str) -> None:
    place = segment.joint_offset
    if segment.parent < 0:
        for axis in "xyz":
            link = f"{segment.name}_t{axis}_link"
            ElementTree.SubElement(robot, "link", name=link)
            joint = _add_joint(robot, f"{segment.name}_t{axis}", "prismatic", (parent, link))
            _set_axis(joint, axis, place, np.zeros(3))
            parent, place = link, np.zeros(3)
    for axis, offset in zip(AXES, segment.rotation_offset, strict=True):
        link = segment.name if axis == "z" else f"{segment.name}_{axis}_link"
        element = ElementTree.SubElement(robot, "link", name=link)
        if axis == "z":
            _add_inertial(element, segment)
        joint = _add_joint(robot, f"{segment.name}_{axis}", "revolute", (parent, link))
        _set_axis(joint, axis, place, offset * np.array([axis == "x", axis == "y", axis == "z"]))
        parent, place = link, np.zeros(3)


def _add_joint(robot: ElementTree.Element, name: str, kind: str, links: tuple[str, str]) -> ElementTree.Element:
    joint = ElementTree.SubElement(robot, "joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=links[0])
    ElementTree.SubElement(joint, "child", link=links[1])
    return joint


def _set_axis(joint: ElementTree.Element, axis: str, place: np.ndarray, rpy: np.ndarray) -> None:
    ElementTree.SubElement(joint, "origin", xyz=_numbers(place), rpy=_numbers(rpy))
    ElementTree.SubElement(joint, "axis", xyz=AXES[axis])
    ElementTree.SubElement(joint, "limit", TRAVEL if joint.get("type") == "prismatic" else LIMIT)


def _add_inertial(link: ElementTree.Element, segment: Segment) -> None:
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "origin", xyz=_numbers(segment.centre_of_mass), rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=repr(float(segment.mass)))
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    values = segment.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    ElementTree.SubElement(inertial, "inertia", {n: repr(float(x)) for n, x in zip(names, values, strict=True)})


def _numbers(values: np.ndarray) -> str:
    return " ".join(repr(float(x)) for x in values)
