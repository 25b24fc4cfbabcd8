"""A model built from a known body is that body."""

import numpy as np
import pytest

from gaitlab.errors import InvalidSubject
from gaitlab.multibody.contact import floor_height
from gaitlab.multibody.kinematics import point_positions
from gaitlab.multibody.scaling import SubjectSettings, build_subject, trunk_direction
from tests.walking_body import marked_child, measured, walking_coordinates


@pytest.fixture(scope="module")
def child():
    return marked_child()


@pytest.fixture(scope="module")
def body(child):
    return measured(child, walking_coordinates(child))


@pytest.fixture(scope="module")
def standing(child):
    return measured(child, np.zeros((20, child.n_q)))


def test_joints_and_markers_are_those_of_the_body(child, body):
    built = build_subject(body, 51.0, 1.56)
    for ours, truth in zip(built.segments[1:], child.segments[1:], strict=True):
        np.testing.assert_allclose(ours.joint_offset, truth.joint_offset, atol=1e-12)
    assert set(built.markers) == set(child.markers)
    for name, point in built.markers.items():
        np.testing.assert_allclose(point.position, child.markers[name].position, atol=1e-12)


@pytest.mark.parametrize("table", ["printed", "corrected", "de_leva_male", "de_leva_female"])
@pytest.mark.parametrize("trunk_joint", [False, True])
def test_mass_is_the_body_mass(body, table, trunk_joint):
    built = build_subject(body, 51.0, 1.56, settings=SubjectSettings(anthropometry=table, trunk_joint=trunk_joint))
    assert built.mass == pytest.approx(51.0, rel=1e-12)
    assert built.n_q == (27 if trunk_joint else 24)


def test_contacts_stand_on_the_floor_below_heel_and_toe_markers(child, standing):
    built = build_subject(standing, 51.0, 1.56, settings=SubjectSettings(floor_height=-0.9))
    neutral = np.zeros((1, built.n_q))
    for side, segment in (("right", 3), ("left", 6)):
        neutral[:, 3 + 3 * segment] = (
            child.segments[segment].rotation_offset[0] - built.segments[segment].rotation_offset[0]
        )
        neutral[:, 4 + 3 * segment : 6 + 3 * segment] = child.segments[segment].rotation_offset[1:]
        for part, marker in (("heel", "HEE"), ("toe", "TOE")):
            point = point_positions(built, built.contacts, neutral)[f"{side}_{part}"][0]
            below = standing.markers[side[0].upper() + marker][0] * [1, 1, 0] + [0, 0, -0.9]
            np.testing.assert_allclose(point, below, atol=1e-12)


def test_rigid_trunk_stands_above_the_hips(standing):
    assert trunk_direction(standing) == pytest.approx([0, 0, 1])
    pelvis = build_subject(standing, 51.0, 1.56).segments[0]
    assert pelvis.centre_of_mass[:2] == pytest.approx([0, 0])
    leaning = SubjectSettings(trunk_direction=np.array([0.5, 0.0, 1.0]))
    assert build_subject(standing, 51.0, 1.56, settings=leaning).segments[0].centre_of_mass[0] > 0.05


@pytest.mark.parametrize(("mass", "height", "word"), [(0.0, 1.5, "mass"), (51.0, 156.0, "height")])
def test_impossible_measurements(body, mass, height, word):
    with pytest.raises(InvalidSubject, match=f"Body {word}"):
        build_subject(body, mass, height)


def test_floor_is_zero_unless_the_feet_never_come_near_it():
    feet = {name: np.full((10, 3), 0.05) for name in ("LHEE", "RHEE", "LTOE", "RTOE")}
    assert floor_height(feet) == 0.0
    assert floor_height({name: x + 0.4 for name, x in feet.items()}) == pytest.approx(0.425)
