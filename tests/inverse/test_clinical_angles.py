import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gaitlab.inverse.clinical_angles import CURVES, cardan_yxz, clinical_angles, forward_direction, travel_heading

SEGMENTS = ["pelvis"] + [
    f"{side}_{name}" for side in ("left", "right") for name in ("thigh", "shank", "shank_torsioned", "foot")
]


def upright(n=5):
    return {name: np.broadcast_to(np.eye(3), (n, 3, 3)) for name in SEGMENTS}


def turned(axis, angle, n=5):
    return np.tile(Rotation.from_euler(axis, angle).as_matrix(), (n, 1, 1))


def degrees_of(rotations, forward=0.0):
    return {name: np.degrees(angle[0]) for name, angle in clinical_angles(rotations, forward).items()}


def test_cardan_angles_agree_with_scipy():
    angles = np.random.default_rng(2).uniform(-1.2, 1.2, (200, 3))
    R = np.stack([Rotation.from_euler("YXZ", a).as_matrix() for a in angles])
    np.testing.assert_allclose((cardan_yxz(R) - angles + np.pi) % (2 * np.pi), np.pi, atol=1e-9)


def test_cardan_angles_run_through_gimbal_lock():
    middle = np.linspace(-2.0, 2.0, 100)
    R = Rotation.from_euler("YXZ", np.stack([0.1 * middle, middle, 0.3 + 0 * middle], 1)).as_matrix()
    found = cardan_yxz(R)
    assert np.abs(np.diff(found, axis=0)).max() < 0.05
    np.testing.assert_allclose(np.ptp(found[:, 1]), 4.0, atol=1e-9)


def test_cardan_angles_unwrap_across_a_gap():
    turn = np.linspace(0.0, 9.0, 200)
    R = Rotation.from_euler("YXZ", np.stack([0 * turn, 0 * turn, turn], 1)).as_matrix()
    R[50:60] = np.nan
    found = cardan_yxz(R)[:, 2]
    assert np.isnan(found[50:60]).all()
    np.testing.assert_allclose(found[60:], turn[60:], atol=1e-9)


def test_standing_upright_is_zero_everywhere():
    assert max(abs(value) for value in degrees_of(upright()).values()) < 1e-12


@pytest.mark.parametrize(
    ("segment", "axis", "angle", "expected"),
    [
        ("pelvis", "y", 10, {"left_pelvis_tilt": 10, "right_pelvis_tilt": 10, "left_hip_flexion": 10}),
        ("pelvis", "x", 5, {"left_pelvis_obliquity": 5, "right_pelvis_obliquity": -5}),  # y is left: left side up
        ("pelvis", "z", 8, {"right_pelvis_rotation": 8, "left_pelvis_rotation": -8}),  # right side forward
        ("left_thigh", "y", -30, {"left_hip_flexion": 30, "left_knee_flexion": 30, "right_hip_flexion": 0}),
        ("right_thigh", "x", 7, {"right_hip_adduction": 7}),  # foot to the left
        ("left_thigh", "x", -7, {"left_hip_adduction": 7}),
        ("left_thigh", "z", -6, {"left_hip_rotation": 6}),  # toes to the right
        ("right_shank", "y", 60, {"right_knee_flexion": 60}),
        ("left_foot", "y", -12, {"left_ankle_dorsiflexion": 12}),  # toes up
        ("left_foot", "z", -9, {"left_foot_progression": 9, "left_ankle_rotation": 9}),
        ("right_foot", "z", 9, {"right_foot_progression": 9, "right_ankle_rotation": 9}),
    ],
)
def test_signs_are_clinical(segment, axis, angle, expected):
    rotations = upright() | {segment: turned(axis, np.radians(angle))}
    found = degrees_of(rotations)
    assert {name: pytest.approx(value, abs=1e-9) for name, value in expected.items()} == {n: found[n] for n in expected}


def test_nine_curves_of_both_sides_exist():
    assert {f"{side}_{curve}" for side in ("left", "right") for curve in CURVES} <= set(degrees_of(upright()))


def test_direction_that_is_called_forward_turns_only_pelvis_and_foot():
    rotations = {name: turned("z", 1.6) for name in SEGMENTS}
    heading = travel_heading(np.outer(np.arange(5), [-0.03, 1.0, 0.0]), rotations["pelvis"][:, :, 0])
    assert forward_direction(heading, "laboratory axis") == pytest.approx(np.pi / 2)
    found = degrees_of(rotations, forward_direction(heading, "laboratory axis"))
    assert found["right_pelvis_rotation"] == pytest.approx(np.degrees(1.6) - 90)
    assert found["right_hip_rotation"] == pytest.approx(0.0, abs=1e-9)


def test_who_stands_or_walks_backwards_faces_forward():
    facing = np.broadcast_to([0.0, -1.0, 0.0], (5, 3))
    assert travel_heading(np.outer(np.arange(5), [0.01, 0.02, 0.0]), facing) == pytest.approx(-np.pi / 2)
    assert travel_heading(np.outer(np.arange(5), [0.1, 1.0, 0.0]), facing) == pytest.approx(-np.pi / 2)
