"""A walking body of known coordinates: truth for scaling and inverse kinematics."""

from dataclasses import replace

import numpy as np

from gaitlab.multibody.kinematics import forward_kinematics, point_positions
from gaitlab.multibody.presets import thesis_able_bodied_child
from gaitlab.multibody.scaling import MeasuredBody
from gaitlab.multibody.subject import PointOnSegment

RATE = 100.0
JOINTS = {"hip": "thigh", "knee": "shank", "ankle": "foot"}
PLACES = {
    "pelvis": {"LASI": (0.09, 0.11, 0.06), "RASI": (0.09, -0.11, 0.06), "SACR": (-0.1, 0, 0.08)},
    "thigh": {"THI": (0.02, 0.07, -0.2), "KNE": (0, 0.05, -0.38)},
    "shank": {"TIB": (0.02, 0.05, -0.2), "ANK": (0, 0.04, -0.37), "TUB": (0.05, 0, -0.05)},
    "foot": {"HEE": (-0.02, 0, 0.05), "P5M": (-0.02, 0.03, -0.08)},
}


def marked_child():
    """The able-bodied child with markers; toe markers on the tip that defines the foot's axis."""
    child = thesis_able_bodied_child()
    names = [segment.name for segment in child.segments]
    markers = {
        name: PointOnSegment(segment=0, position=np.array(place, float)) for name, place in PLACES["pelvis"].items()
    }
    for side, outward in (("left", 1), ("right", -1)):
        letter = side[0].upper()
        for kind in ("thigh", "shank", "foot"):
            for name, place in PLACES[kind].items():
                position = np.array(place) * [1, outward, 1]
                markers[letter + name] = PointOnSegment(segment=names.index(f"{side}_{kind}"), position=position)
        markers[letter + "TOE"] = child.contacts[f"{side}_toe"]
    return replace(child, markers=markers)


def walking_coordinates(child, n=120):
    """Smooth coordinates with the amplitudes and the pace of a walk, shape (n, n_q)."""
    generator, t = np.random.default_rng(5), np.arange(n) / RATE
    q = np.zeros((n, child.n_q))
    for i in range(3, child.n_q):
        phases = generator.uniform(0, 2 * np.pi, size=2)
        q[:, i] = 0.2 * np.sin(2 * np.pi * t + phases[0]) + 0.05 * np.sin(4 * np.pi * t + phases[1])
    q[:, 0], q[:, 2] = 1.2 * t - 0.7, 0.8
    q[:, 9:18:9] += 0.5  # knees bend one way
    q[:, 18] += 0.5
    return q


def measured(child, q):
    """The body as an error-free direct model would see it."""
    names, poses = [segment.name for segment in child.segments], forward_kinematics(child, q)
    sides = ("left", "right")
    centres = {f"{s}_{j}": poses.origins[:, names.index(f"{s}_{k}")] for s in sides for j, k in JOINTS.items()}
    axes = {name: poses.rotations[:, i] for i, name in enumerate(names)}
    return MeasuredBody(joint_centres=centres, axes=axes, markers=point_positions(child, child.markers, q))
