import numpy as np
import pytest
from synthetic_output import document, walk_arrays, write_output

from gaitlab.errors import OutputError
from gaitlab.viewer.motion import CENTRE, CONTACTS, LAYERS, MEASURED, OPTIMAL, PLATES, PRESSURE, read_motion


def motion(directory, **changes):
    arrays = {name: array for name, array in (walk_arrays() | changes).items() if array is not None}
    return read_motion(write_output(directory, document(), arrays))


def test_a_complete_walk_has_every_layer(tmp_path):
    assert motion(tmp_path).layers == LAYERS


@pytest.mark.parametrize(
    ("key", "lost"),
    [
        ("segment_positions_optimal", {OPTIMAL, CONTACTS}),
        ("cop_plates", {PLATES, PRESSURE}),
        ("bones", {MEASURED, OPTIMAL}),
        ("contact_names", {CONTACTS}),
        ("centre_of_mass_measured", {CENTRE}),
    ],
)
def test_what_is_absent_has_no_layer(tmp_path, key, lost):
    assert set(LAYERS) - set(motion(tmp_path, **{key: None}).layers) == lost


def test_bones_that_lead_nowhere_are_left_out(tmp_path):
    assert motion(tmp_path, bones=np.array([(0, 1), (1, 99), (-1, 2)])).bones.tolist() == [[0, 1]]


def test_bones_know_their_side(tmp_path):
    assert motion(tmp_path).bone_sides == ("right",) * 4 + ("left",) * 4


def test_contacts_act_at_the_toes_and_below_the_ankles(tmp_path):
    shown = motion(tmp_path)
    heel, toe = shown.contacts.origins[:, 0], shown.contacts.origins[:, 1]
    assert toe == pytest.approx(shown.optimal[:, 7])
    assert heel[:, :2] == pytest.approx(shown.optimal[:, 3, :2]) and np.ptp(heel[:, 2]) == 0.0


def test_stored_contact_points_are_preferred(tmp_path):
    stored = np.ones((241, 4, 3))
    assert motion(tmp_path, contact_positions_optimal=stored).contacts.origins == pytest.approx(stored)


def test_the_largest_force_is_an_arrow_of_known_length(tmp_path):
    shown = motion(tmp_path)
    assert shown.metres_per_newton * np.linalg.norm(shown.plates.vectors, axis=2).max() == pytest.approx(0.9)


def test_trails_lead_up_to_the_frame_for_a_second(tmp_path):
    shown = motion(tmp_path)
    pieces = shown.trails(150)
    assert len(pieces) == 3 * 100
    assert pieces[-3, 1] == pytest.approx(shown.centre[150]) and pieces[0, 0] == pytest.approx(shown.centre[50])
    assert pieces[-1, 1] == pytest.approx(shown.measured[150, -1])
    assert len(shown.trails(0)) == 0


def test_without_a_skeleton_the_markers_lead(tmp_path):
    shown = motion(tmp_path, segment_positions_measured=None, segment_positions_optimal=None)
    assert shown.pelvis == pytest.approx(shown.markers.mean(axis=1))


def test_a_walk_with_nothing_to_show_is_refused(tmp_path):
    with pytest.raises(OutputError, match="neither markers nor segment positions"):
        read_motion(write_output(tmp_path, document(), {"time": np.arange(3.0)}))
