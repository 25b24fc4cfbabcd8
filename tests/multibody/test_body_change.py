"""Changed bodies against sums over mass points."""

import numpy as np
import pytest

from gaitlab.multibody.body_change import heavier, segment_length, stretched, twisted
from gaitlab.multibody.kinematics import point_positions
from gaitlab.multibody.subject import PointOnSegment, Segment, SubjectModel

RANDOM = np.random.default_rng(3)
POINTS = RANDOM.normal(size=(40, 3)) * (0.03, 0.04, 0.1) - (0.0, 0.0, 0.15)
MASSES = RANDOM.uniform(0.05, 0.1, 40)


def segment(name, parent, offset, points=POINTS):
    centre = MASSES @ points / MASSES.sum()
    r = points - centre
    inertia = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(MASSES, r, strict=True))
    return Segment(
        name=name, parent=parent, joint_offset=np.array(offset), rotation_offset=np.zeros(3), mass=float(MASSES.sum()),
        centre_of_mass=centre, inertia=inertia,
    )  # fmt: skip


def body(points=POINTS, length=0.4):
    return SubjectModel(
        name="leg",
        segments=(
            segment("pelvis", -1, (0.0, 0.0, 0.0)),
            segment("right_thigh", 0, (0.0, -0.1, 0.0), points),
            segment("right_shank", 1, (0.0, 0.0, -length)),
            segment("right_foot", 2, (0.0, 0.0, -0.35)),
        ),
        contacts={
            "right_heel": PointOnSegment(segment=3, position=np.array([-0.05, 0.0, -0.06])),
            "right_toe": PointOnSegment(segment=3, position=np.array([0.12, 0.0, -0.06])),
        },
        markers={"RKNE": PointOnSegment(segment=1, position=np.array([0.0, -0.05, -0.4]))},
    )


def test_a_stretched_segment_is_that_of_stretched_mass_points():
    long, truth = stretched(body(), "right_thigh", 1.25), body(POINTS * (1.0, 1.0, 1.25), 0.5)
    for name in ("centre_of_mass", "inertia", "mass"):
        assert getattr(long.segments[1], name) == pytest.approx(getattr(truth.segments[1], name), abs=1e-12)
    assert long.segments[2].joint_offset == pytest.approx(truth.segments[2].joint_offset)
    assert long.markers["RKNE"].position == pytest.approx([0.0, -0.05, -0.5])
    assert segment_length(long, "right_thigh") == pytest.approx(0.5)


def test_a_foot_is_stretched_along_its_sole():
    long = stretched(body(), "right_foot", 1.1)
    assert segment_length(long, "right_foot") == pytest.approx(1.1 * 0.17)
    assert long.contacts["right_heel"].position[2] == pytest.approx(-0.06)


def test_mass_and_inertia_grow_together():
    heavy = heavier(body(), "right_shank", 1.5)
    assert heavy.mass == pytest.approx(body().mass + 0.5 * MASSES.sum())
    assert heavy.segments[2].inertia == pytest.approx(1.5 * body().segments[2].inertia)


def test_torsion_turns_what_lies_below_about_the_long_axis():
    q = np.zeros((1, 15))
    before, after = (point_positions(s, s.contacts, q) for s in (body(), twisted(body(), "right_thigh", 0.3)))
    c, s = np.cos(0.3), np.sin(0.3)
    hip = np.array([0.0, -0.1, 0.0])
    turned = hip + (before["right_toe"] - hip) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    assert after["right_toe"] == pytest.approx(turned, abs=1e-12)
