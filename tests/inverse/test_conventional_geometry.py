import numpy as np
import pytest

from gaitlab.inverse.conventional_geometry import angle_about, chord, cross, frame_from_z, rotate, rotation_z, unit

RNG = np.random.default_rng(1)


def random_vectors(n=50):
    return RNG.normal(size=(n, 3))


def leg_with_known_centre(wand_angle, n=50):
    """Proximal centre, lateral marker 5 cm from the joint centre across the bone, and a wand at a known angle."""
    proximal, bone = random_vectors(n), unit(random_vectors(n))
    lateral = unit(cross(bone, random_vectors(n)))
    centre = proximal - 0.4 * bone
    wand = centre + RNG.uniform(0.05, 0.3, (n, 1)) * bone + 0.08 * rotate(lateral, bone, wand_angle)
    return proximal, centre, centre + 0.05 * lateral, wand


@pytest.mark.parametrize("wand_angle", [0.0, 0.3, -0.3, 1.2, -1.74, 2.5])
def test_chord_finds_the_joint_centre(wand_angle):
    proximal, centre, marker, wand = leg_with_known_centre(wand_angle)
    np.testing.assert_allclose(chord(proximal, marker, wand, 0.05, wand_angle), centre, atol=1e-12)


def test_chord_longer_than_the_bone_has_no_joint_centre():
    proximal, _, marker, wand = leg_with_known_centre(0.0)
    assert np.isnan(chord(proximal, marker, wand, 0.5, 0.0)).all()


def test_chord_keeps_missing_frames_missing():
    proximal, centre, marker, wand = leg_with_known_centre(0.2)
    wand[3] = np.nan
    found = chord(proximal, marker, wand, 0.05, 0.2)
    assert np.isnan(found[3]).all()
    np.testing.assert_allclose(np.delete(found, 3, 0), np.delete(centre, 3, 0), atol=1e-12)


def test_angle_about_is_the_angle_that_was_turned():
    axis = unit(random_vectors())
    start = unit(cross(axis, random_vectors()))
    end = rotate(start, axis, -2.0) + RNG.normal(size=(50, 1)) * axis
    np.testing.assert_allclose(angle_about(axis, start, end), -2.0)


def test_frame_from_z_is_right_handed_with_y_next_to_the_hint():
    z, hint = random_vectors(), random_vectors()
    R = frame_from_z(z, hint)
    np.testing.assert_allclose(R.transpose(0, 2, 1) @ R, np.broadcast_to(np.eye(3), R.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(R), 1.0)
    assert (np.einsum("ij,ij->i", R[:, :, 1], hint) > 0).all()


def test_rotation_z_agrees_with_rotate():
    x = np.array([[1.0, 0.0, 0.0]])
    np.testing.assert_allclose(rotation_z(0.7)[:, 0], rotate(x, np.array([[0.0, 0.0, 1.0]]), 0.7)[0])
