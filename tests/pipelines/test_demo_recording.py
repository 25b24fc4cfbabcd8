"""Markers and plates of the demo children against the truth they were made from."""

import numpy as np
import pytest

from gaitlab.inverse.conventional import joint_kinematics
from gaitlab.inverse.static import calibrate_subject
from gaitlab.mocap.force_plates import centre_of_pressure
from gaitlab.multibody.kinematics import forward_kinematics, point_positions
from gaitlab.pipelines.demo_gait import reference_gait
from gaitlab.pipelines.demo_patterns import demo_patterns
from gaitlab.pipelines.demo_recording import Laboratory, walk_recording
from gaitlab.pipelines.demo_reference import reference_walk
from gaitlab.pipelines.demo_subject import demo_subject

JOINTS = {"hip": "thigh", "knee": "shank", "ankle": "foot"}


@pytest.fixture(scope="module", params=[0, 1], ids=["cp", "able"])
def case(request):
    pattern = demo_patterns()[request.param]
    child = demo_subject(pattern)
    walk = reference_walk(reference_gait(pattern, child.model))
    return child.model, child.static, walk, walk_recording("walk", walk, child.parameters, Laboratory())


def test_the_conventional_model_finds_the_joint_centres(case):
    subject, static, walk, recording = case
    found = joint_kinematics(recording, calibrate_subject(static, recording, {})).joint_centres
    names, origins = [s.name for s in subject.segments], forward_kinematics(subject, walk.q).origins
    for side in ("left", "right"):
        for joint, carried in JOINTS.items():
            true = origins[:, names.index(f"{side}_{carried}")] - [np.median(walk.q[:, 0]), 0.0, 0.0]
            assert np.linalg.norm(true - found[f"{side}_{joint}"], axis=1).max() < 2e-4


def test_the_child_stands_with_flat_feet(case):
    _, static, _, _ = case
    for name in ("LHEE", "LTOE", "RHEE", "RTOE"):
        np.testing.assert_allclose(static.markers[name][:, 2], 0.03, atol=2e-4)


def test_the_first_plate_measures_the_right_foot_and_the_second_the_left(case):
    _, _, walk, recording = case
    for plate, side in zip(recording.force_plates, ("right", "left"), strict=True):
        whole = walk.forces[f"{side}_heel"] + walk.forces[f"{side}_toe"]
        loaded = plate.force[: len(whole), 2] > 1.0
        np.testing.assert_allclose(plate.force[: len(whole)][loaded], whole[loaded], atol=0.01)


def test_the_centre_of_pressure_lies_between_heel_and_toe(case):
    subject, _, walk, recording = case
    points = point_positions(subject, subject.contacts, walk.dense_q)
    plate, middle = recording.force_plates[0], np.median(walk.q[:, 0])
    pressure = centre_of_pressure(plate)[: len(walk.dense_q), 0]
    there = np.isfinite(pressure)
    heel, toe = (points[f"right_{part}"][there, 0] - middle for part in ("heel", "toe"))
    assert (pressure[there] > heel - 2e-3).all() and (pressure[there] < toe + 2e-3).all()


def test_a_turned_laboratory_with_noise_sees_the_same_walk(case):
    _, _, walk, straight = case
    laboratory = Laboratory(heading=np.pi, noise=1e-3, seed=1)
    turned = walk_recording("walk", walk, straight.parameters, laboratory)
    difference = turned.markers["LTOE"] * [-1.0, -1.0, 1.0] - straight.markers["LTOE"]
    assert difference.std() == pytest.approx(1e-3, rel=0.1)
    again = walk_recording("walk", walk, straight.parameters, laboratory)
    np.testing.assert_array_equal(turned.markers["LTOE"], again.markers["LTOE"])
