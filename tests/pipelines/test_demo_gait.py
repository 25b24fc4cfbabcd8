"""The reference gaits: periodic, feet that stand where they touch, angles of the pattern."""

import numpy as np
import pytest

from gaitlab.multibody.kinematics import point_positions
from gaitlab.pipelines.demo_gait import in_contact, reference_gait, target_coordinates
from gaitlab.pipelines.demo_patterns import demo_patterns
from gaitlab.pipelines.demo_subject import demo_subject

PATTERNS = {pattern.name: pattern for pattern in demo_patterns()}


@pytest.fixture(scope="module", params=PATTERNS)
def gait(request):
    pattern = PATTERNS[request.param]
    return reference_gait(pattern, demo_subject(pattern).model)


def test_a_stride_later_the_body_is_the_same_but_further(gait):
    time = np.linspace(0.0, 0.4, 7)
    moved = gait.coordinates(time + gait.pattern.stride_time) - gait.coordinates(time)
    np.testing.assert_allclose(moved[:, 0], gait.pattern.speed * gait.pattern.stride_time, atol=1e-12)
    np.testing.assert_allclose(moved[:, 1:], 0.0, atol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_are_those_of_the_coordinates(gait, order):
    time, step = np.array([0.113, 0.571]), 1e-5
    ahead, behind = (gait.coordinates(time + s, order - 1) for s in (step, -step))
    np.testing.assert_allclose(gait.coordinates(time, order), (ahead - behind) / (2 * step), atol=1e-4)


def test_contact_points_stay_on_the_floor_where_they_touch(gait):
    time = np.linspace(0.0, gait.pattern.stride_time, 301)
    for name, path in point_positions(gait.subject, gait.subject.contacts, gait.coordinates(time)).items():
        side, part = name.split("_")
        touches, stride = in_contact(gait.pattern, side, part, time)
        path[:, 0] -= stride * gait.pattern.speed * gait.pattern.stride_time
        assert np.abs(path[touches] - np.median(path[touches], axis=0)).max() < 2e-3
        assert np.abs(path[touches, 2]).max() < 2e-3
        assert path[~touches, 2].min() > -1e-3


def test_angles_are_near_the_pattern(gait):
    share = np.linspace(0.0, 1.0, 100, endpoint=False)
    q = gait.coordinates(share * gait.pattern.stride_time)[:, 3:]
    difference = q - target_coordinates(gait.subject, gait.pattern, share)[:, 3:]
    assert np.degrees(np.sqrt(np.mean(difference**2))) < 4.0


def test_knees_of_the_child_with_cerebral_palsy_never_stretch():
    knee = PATTERNS["demo_cp_child"].curve("knee_flexion", np.linspace(0, 1, 50))
    healthy = PATTERNS["demo_able_bodied_child"].curve("knee_flexion", np.linspace(0, 1, 50))
    assert np.degrees(knee.min()) > 20.0 > 7.0 > np.degrees(healthy.min())
