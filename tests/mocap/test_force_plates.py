"""Plates of types 1 to 4 that all carry the same known force at the same known point."""

from dataclasses import replace

import numpy as np
import pytest
from raw_file import raw_recording
from synthetic_walk import rectangle

from gaitlab.mocap.force_plates import at_video_frames, centre_of_pressure, force_plates, plate_channels

Z_UP = np.eye(3)
FORCE = np.array([-30.0, 12.0, 600.0])  # N, on the foot, laboratory axes
POINT = np.array([1.1, 0.45, 0.2])  # m
FREE = 4.0  # N*m, about the vertical
CORNERS = rectangle(1.0, 0.5, 0.2)  # m; x of the plate along x of the laboratory, z down
DEPTH = 0.04  # m, of the sensors below the surface
A, B = 0.2, 0.15  # m, half distances of the sensors of type 3
MATRIX = np.diag([100.0, 110.0, 300.0, 5e4, 6e4, 7e4]) + np.arange(36.0).reshape(6, 6)  # N/V and N*mm/V


def in_plate() -> tuple[np.ndarray, np.ndarray]:
    """Force [N] and its point from the centre of the surface [m], plate axes (y and z are turned round)."""
    turn = np.array([1.0, -1.0, -1.0])
    return turn * FORCE, turn * (POINT - CORNERS.mean(axis=0))


def channels(kind: int) -> np.ndarray:
    force, point = in_plate()
    free = np.array([0.0, 0.0, -FREE])
    about_sensors = np.cross(point - [0.0, 0.0, DEPTH], force) + free  # the sensors lie at +z
    six = np.concatenate([force, 1e3 * about_sensors])
    return {
        1: np.concatenate([force, 1e3 * point[:2], 1e3 * free[2:]]),
        2: six,
        3: four_sensors(force, about_sensors),
        4: np.linalg.solve(MATRIX, six),
    }[kind]


def four_sensors(force: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Fx12 Fx34 Fy14 Fy23 Fz1 ... Fz4 at (a, b), (-a, b), (-a, -b), (a, -b) with the given sum and moment."""
    places = np.array([[A, B, 0], [-A, B, 0], [-A, -B, 0], [A, -B, 0]])
    unknowns = [(0, [0, 1]), (0, [2, 3]), (1, [0, 3]), (1, [1, 2]), (2, [0]), (2, [1]), (2, [2]), (2, [3])]
    columns = []
    for axis, sensors in unknowns:
        unit = np.eye(3)[axis]
        arm = places[sensors].mean(axis=0)
        columns.append(np.concatenate([unit, np.cross(arm, unit)]))
    return np.linalg.lstsq(np.array(columns).T, np.concatenate([force, moment]), rcond=None)[0]


def origin(kind: int) -> np.ndarray:
    return {1: np.zeros(3), 2: [0, 0, -DEPTH], 3: [A, B, -DEPTH], 4: [0, 0, -DEPTH]}[kind] * np.full(3, 1e3)


def recording(*kinds: int, **changes):
    samples = np.concatenate([channels(kind) for kind in kinds])
    starts = np.cumsum([0] + [len(channels(kind)) for kind in kinds])
    channel = np.zeros((8, len(kinds)))
    for k, kind in enumerate(kinds):
        n = len(channels(kind))
        channel[:n, k] = starts[k] + 1.0 + np.arange(n)
    group = {
        "USED": np.array([len(kinds)]),
        "TYPE": np.array(kinds),
        "CORNERS": np.stack([1e3 * CORNERS.T] * len(kinds), axis=2),
        "ORIGIN": np.stack([origin(kind) for kind in kinds], axis=1),
        "CHANNEL": channel,
        "CAL_MATRIX": np.stack([MATRIX] * len(kinds), axis=2),
    }
    return raw_recording(
        points=np.ones((2, 1, 3)),
        analog=np.tile(samples, (4, 1)),
        parameters={"FORCE_PLATFORM": group | changes},
    )


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_every_type_gives_the_force_on_the_foot_and_its_point(kind):
    (plate,), warnings = force_plates(recording(kind), 1e-3, Z_UP)
    assert warnings == ()
    assert plate.force == pytest.approx(np.tile(FORCE, (4, 1)))
    assert plate.moment[0] == pytest.approx(np.cross(POINT - CORNERS.mean(axis=0), FORCE) + [0, 0, FREE])
    assert centre_of_pressure(plate)[0] == pytest.approx(POINT)


def test_mixed_types_in_one_file():
    raw = recording(1, 3, 2, 4)
    plates, _ = force_plates(raw, 1e-3, Z_UP)
    assert [plate.force[0] for plate in plates] == [pytest.approx(FORCE)] * 4
    assert plate_channels(raw) == frozenset(range(26))


def test_origin_stated_the_other_way_round():
    """Vicon stores the vector from the surface to the sensors, with positive z."""
    (plate,), _ = force_plates(recording(2, ORIGIN=np.array([[0.0, 0.0, 1e3 * DEPTH]]).T), 1e-3, Z_UP)
    assert centre_of_pressure(plate)[0] == pytest.approx(POINT)


def test_force_on_the_plate_is_turned_round_with_a_warning():
    raw = recording(2)
    (plate,), warnings = force_plates(replace(raw, analog=-raw.analog), 1e-3, Z_UP)
    assert plate.force[0] == pytest.approx(FORCE)
    assert "its sign is changed to the force on the foot" in warnings[0]


def test_zero_offset_is_taken_from_the_stated_frames():
    raw = recording(2, ZERO=np.array([1.0, 1.0]))
    offset = np.array([5.0, -3.0, 20.0, 100.0, 200.0, -50.0])
    analog = raw.analog + offset
    analog[:2] = offset  # unloaded in the first of two frames
    (plate,), _ = force_plates(replace(raw, analog=analog), 1e-3, Z_UP)
    assert plate.force[0] == pytest.approx(np.zeros(3))
    assert plate.force[3] == pytest.approx(FORCE)


def test_units_of_the_channels_are_honoured():
    raw = recording(2)
    analog = raw.analog * [1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3]
    units = {"ANALOG": {"UNITS": ("kN", "kN", "kN", "N.m", "N.m", "Nm")}}
    (plate,), _ = force_plates(replace(raw, analog=analog, parameters=raw.parameters | units), 1e-3, Z_UP)
    assert centre_of_pressure(plate)[0] == pytest.approx(POINT)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"TYPE": np.array([6])}, "its type is 6, gaitlab knows types 1 to 4"),
        ({"CORNERS": np.zeros((3, 4, 1))}, "its corners do not span a rectangle"),
        ({"CORNERS": np.zeros(3)}, "FORCE_PLATFORM:CORNERS is missing or too short"),
        ({"CHANNEL": np.full((6, 1), 99.0)}, "its channels are not in the file"),
    ],
)
def test_a_plate_that_cannot_be_used_is_left_out_with_a_warning(changes, said):
    plates, warnings = force_plates(recording(2, **changes), 1e-3, Z_UP)
    assert plates == ()
    assert warnings == (f"force plate 1 is not used: {said}",)


def test_no_pressure_centre_without_load():
    (plate,), _ = force_plates(recording(2), 1e-3, Z_UP)
    assert np.isnan(centre_of_pressure(replace(plate, force=0.01 * plate.force))).all()


@pytest.mark.shared_data
def test_ankle_moments_of_the_real_walks(real_recordings):
    """|(p - ankle) x F + M| is the file's ankle moment but for the foot's weight and inertia (about 1 N*m)."""
    for walk in (read for name, read in real_recordings.items() if name.startswith("straight")):
        weight = 9.81 * walk.parameters["mass"]
        for plate in (at_video_frames(p, walk.rate, walk.n_frames) for p in walk.force_plates):
            centre = plate.corners.mean(axis=0)
            errors = []
            for letter in "LR":
                ankle, stored = walk.model_outputs[letter + "TIO"], walk.model_outputs[letter + "AnkleMoment"]
                near = np.linalg.norm((ankle - centre)[:, :2], axis=1) < 0.3
                carried = near & (plate.force[:, 2] > 0.5 * weight) & np.isfinite(stored[:, 0])
                ours = np.cross(centre - ankle, plate.force) + plate.moment
                theirs = 1e-3 * walk.parameters["mass"] * np.linalg.norm(stored, axis=1)
                if carried.sum() > 20:
                    errors.append(np.linalg.norm(ours, axis=1)[carried] - theirs[carried])
            assert np.sqrt(np.mean(np.concatenate(errors) ** 2)) < 1.2
            assert 0.9 * weight < np.percentile(plate.force[:, 2], 99) < 1.6 * weight
