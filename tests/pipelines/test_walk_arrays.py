import numpy as np
import pinocchio as pin
import pytest
from walking_body import marked_child, walking_coordinates

from gaitlab.mocap.recording import Event, ForcePlate
from gaitlab.multibody.pinocchio_model import to_pinocchio
from gaitlab.pipelines.walk_arrays import centre_of_mass, centred_means, plate_at_frames, support_phases

CORNERS = np.array([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 2.0, 0.0], [1.0, 2.0, 0.0]])


def event(side, kind, time):
    return Event(side=side, kind=kind, time=time, source="file")


def test_centre_of_pressure_is_where_the_force_was_put():
    force = np.tile([30.0, -20.0, 700.0], (100, 1))
    arm = np.array([0.1, -0.2, 0.0])
    plate = ForcePlate(corners=CORNERS, force=force, moment=np.cross(arm, force), rate=1000.0)
    force_at, centre = plate_at_frames(plate, 100.0, 10)
    assert centre[5] == pytest.approx([1.6, 1.3, 0.0])
    assert force_at[5] == pytest.approx([30.0, -20.0, 700.0])


def test_an_empty_plate_has_no_centre_of_pressure():
    plate = ForcePlate(corners=CORNERS, force=np.zeros((100, 3)), moment=np.zeros((100, 3)), rate=1000.0)
    assert np.isnan(plate_at_frames(plate, 100.0, 10)[1]).all()


@pytest.mark.parametrize("per_frame", [1, 9, 10])
def test_means_over_a_frame_are_centred(per_frame):
    ramp = np.arange(30.0 * per_frame)[:, None] * np.ones(3)
    means = centred_means(ramp, per_frame, 30)
    assert means[1:29] == pytest.approx(np.arange(1, 29)[:, None] * per_frame * np.ones(3))


def test_frames_after_the_last_sample_are_unknown():
    assert np.isnan(centred_means(np.ones((10, 3)), 1.0, 20)[15]).all()


def test_phases_follow_the_events_of_both_sides():
    events = [
        event("left", "foot_strike", 0.1),
        event("right", "foot_off", 0.2),
        event("right", "foot_strike", 0.5),
        event("left", "foot_off", 0.6),
    ]
    phases = support_phases(events, np.array([0.0, 0.15, 0.3, 0.55, 0.7]))
    assert phases.tolist() == ["right support", "double support", "left support", "double support", "right support"]


def test_without_events_the_phase_is_unknown():
    assert support_phases([], np.zeros(3)).tolist() == ["", "", ""]


def test_the_centre_of_mass_is_the_one_of_pinocchio():
    child = marked_child()
    q = walking_coordinates(child, 5)
    model = to_pinocchio(child)
    data = model.createData()
    expected = [pin.centerOfMass(model, data, row) for row in q]
    assert centre_of_mass(child, q, 0.0) == pytest.approx(np.array(expected), abs=1e-12)
