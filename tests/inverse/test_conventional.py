"""Against the outputs of Plug-in Gait that the files hold."""

import csv
import time
from dataclasses import replace

import numpy as np
import pytest

from gaitlab.errors import InvalidRecording
from gaitlab.inverse.conventional import KinematicsSettings, joint_kinematics
from gaitlab.inverse.static import CalibrationSettings, calibrate_subject

CHILDREN = ["HC002D", "HC030A", "HC032A", "HC033A", "HC040A", "HC050A"]
TOLERANCE_MM = 0.1
TOLERANCE_DEG = {"file": 0.1, "static": 0.2}

pytestmark = pytest.mark.shared_data


def rms(values):
    return np.sqrt(np.nanmean(np.square(values)))


def difference(ours, theirs, name):
    """Degrees. On turns Vicon's foot progression may lie on another branch of its arc sine, 180 - x or 180 + x."""
    branches = [ours - theirs]
    if "foot_progression" in name and np.nanmax(np.abs(theirs)) > 60:
        branches += [180 - ours - theirs, 180 + ours - theirs]
    wrapped = (np.array(branches) + 180) % 360 - 180
    return np.take_along_axis(wrapped, np.abs(wrapped).argmin(axis=0)[None], axis=0)[0]


def worst(recording, kinematics, vicon):
    """Largest rms of a joint centre [mm] and of a curve [deg], over the frames where Vicon's own are valid."""
    curves, centres = vicon(recording)
    for name, values in centres.items():
        assert not (np.isfinite(values) & ~np.isfinite(kinematics.joint_centres[name])).any(), f"{name} has holes"
    distance = {n: np.linalg.norm(1e3 * (kinematics.joint_centres[n] - v), axis=1) for n, v in centres.items()}
    angle = {n: difference(np.degrees(kinematics.angles[n]), v, n) for n, v in curves.items()}
    return max(map(rms, distance.values())), max(map(rms, angle.values()))


def compare(static, walk, offsets, vicon):
    calibration = calibrate_subject(static, walk, {}, CalibrationSettings(offsets=offsets))
    millimetres, degrees = worst(walk, joint_kinematics(walk, calibration), vicon)
    assert millimetres < TOLERANCE_MM
    assert degrees < TOLERANCE_DEG[offsets]


@pytest.mark.parametrize("offsets", ["file", "static"])
@pytest.mark.parametrize("kind", ["straight", "turn"])
@pytest.mark.parametrize("child", CHILDREN)
def test_children(trial, vicon, child, kind, offsets):
    compare(trial(f"children/{child}/static*"), trial(f"children/{child}/{kind}*"), offsets, vicon)


@pytest.mark.parametrize("offsets", ["file", "static"])
@pytest.mark.parametrize("child", CHILDREN)
def test_the_static_itself(trial, vicon, child, offsets):
    static = trial(f"children/{child}/static*")
    calibration = calibrate_subject(static, static, {}, CalibrationSettings(offsets=offsets))
    millimetres, degrees = worst(static, joint_kinematics(static, calibration, KinematicsSettings(foot="sole")), vicon)
    assert millimetres < TOLERANCE_MM
    assert degrees < TOLERANCE_DEG[offsets]


@pytest.mark.parametrize("offsets", ["file", "static"])
@pytest.mark.parametrize(("static", "walk"), [("BP01", "BP06"), ("BP08", "BP15")], ids=["device", "medial markers"])
def test_adult_with_measured_knee_axis(trial, vicon, static, walk, offsets):
    compare(trial(f"fmc_adult/*{static}"), trial(f"fmc_adult/*{walk}"), offsets, vicon)


def nexus_table(path):
    """Columns of Nexus' table of model outputs by (name, component), shape (n,)."""
    rows = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    names, components, data = rows[2], rows[3], rows[5:]
    columns, name = {}, ""
    for k, component in enumerate(components):
        name = names[k].split(":")[-1] or name
        columns[name, component] = np.array([float(row[k] or "nan") for row in data if len(row) > k])
    return columns


@pytest.mark.parametrize("offsets", ["file", "static"])
def test_stairs_against_the_table_of_nexus(trial, shared_data, offsets):
    static, walk = trial("stairs_adult/Static_trial"), trial("stairs_adult/Movement_trial")
    calibration = calibrate_subject(static, walk, {}, CalibrationSettings(offsets=offsets))
    angles = joint_kinematics(walk, calibration).angles
    table = nexus_table(shared_data / "stairs_adult" / "Movement_trial.csv")
    names = {"hip": "HipAngles", "knee": "KneeAngles", "ankle": "AnkleAngles", "pelvis": "PelvisAngles"}
    parts = {"hip_flexion": "X", "hip_adduction": "Y", "hip_rotation": "Z", "knee_flexion": "X"}
    parts |= {"ankle_dorsiflexion": "X", "pelvis_tilt": "X", "pelvis_obliquity": "Y", "pelvis_rotation": "Z"}
    names["foot"], parts["foot_progression"] = "FootProgressAngles", "Z"
    for side in ("left", "right"):
        for curve, component in parts.items():
            theirs = nexus_column(table, side[0].upper() + names[curve.split("_")[0]], component)
            assert rms(np.degrees(angles[f"{side}_{curve}"]) - theirs) < 0.2, f"{side} {curve}"


def nexus_column(table, name, component):
    return next(values for (n, c), values in table.items() if n.lower() == name.lower() and c == component)


def test_walk_without_static_uses_its_own_offsets(trial, vicon):
    walk = trial("ktk_walk/walk")
    calibration = calibrate_subject(None, walk, {})
    millimetres, degrees = worst(walk, joint_kinematics(walk, calibration), vicon)
    assert millimetres < TOLERANCE_MM
    assert degrees < TOLERANCE_DEG["file"]
    assert calibration.parameters["marker_diameter"] == pytest.approx(0.0095, abs=1e-4)


def test_heading_moves_only_pelvis_rotation_and_foot_progression(trial):
    walk = trial("children/HC002D/straight*")
    calibration = calibrate_subject(None, walk, {})
    vicon_way = joint_kinematics(walk, calibration)
    own_way = joint_kinematics(walk, calibration, KinematicsSettings(forward="heading"))
    turned = own_way.angles["right_pelvis_rotation"] - vicon_way.angles["right_pelvis_rotation"]
    np.testing.assert_allclose(turned[np.isfinite(turned)], vicon_way.forward - own_way.forward, atol=1e-3)
    np.testing.assert_array_equal(own_way.angles["left_hip_rotation"], vicon_way.angles["left_hip_rotation"])


def test_a_missing_marker_is_named(trial):
    walk = trial("children/HC002D/straight*")
    markers = {name: positions for name, positions in walk.markers.items() if name != "LTHI"}
    with pytest.raises(InvalidRecording, match="LTHI"):
        joint_kinematics(replace(walk, markers=markers), calibrate_subject(None, walk, {}))


def test_a_gap_in_one_foot_leaves_the_rest(trial):
    walk = trial("children/HC002D/straight*")
    markers = dict(walk.markers) | {
        "LTOE": np.where(np.arange(walk.n_frames)[:, None] == 100, np.nan, walk.markers["LTOE"])
    }
    angles = joint_kinematics(replace(walk, markers=markers), calibrate_subject(None, walk, {})).angles
    assert np.isnan(angles["left_ankle_dorsiflexion"][100])
    assert np.isfinite(angles["left_knee_flexion"][100])


def test_a_frame_takes_at_most_50_microseconds(trial):
    walk = trial("children/HC030A/straight*")
    calibration = calibrate_subject(None, walk, {})
    seconds = []
    for _ in range(20):
        start = time.perf_counter()
        joint_kinematics(walk, calibration)
        seconds.append(time.perf_counter() - start)
    assert min(seconds) / walk.n_frames < 50e-6
