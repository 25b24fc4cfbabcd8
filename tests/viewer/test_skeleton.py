import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gaitlab.viewer.skeleton import (
    cameras,
    force_arrows,
    place_bones,
    rotation_from_z,
    unit_bone,
    walking_direction,
)


def turned(placement, k, point):
    """A point of the unit mesh where the placement puts it, with an independent rotation."""
    w, x, y, z = placement.rotations[k]
    return Rotation.from_quat([x, y, z, w]).apply(np.array(point) * placement.scales[k]) + placement.positions[k]


def test_a_bone_ends_at_its_joints():
    points = np.random.default_rng(1).normal(size=(6, 3))
    bones = np.array([(0, 1), (2, 3), (5, 4)])
    placement = place_bones(points, bones, 0.02)
    for k, (start, end) in enumerate(bones):
        assert turned(placement, k, (0, 0, 0)) == pytest.approx(points[start])
        assert turned(placement, k, (0, 0, 1)) == pytest.approx(points[end])


@pytest.mark.parametrize("direction", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, -0.6, 0.8)])
def test_rotations_turn_z_into_the_direction(direction):
    w, x, y, z = rotation_from_z(np.array([direction], dtype=float))[0]
    assert Rotation.from_quat([x, y, z, w]).apply([0, 0, 1]) == pytest.approx(direction)


def test_a_bone_with_an_unknown_end_is_hidden():
    placement = place_bones(np.array([[0.0, 0, 0], [np.nan, 0, 0], [0, 0, 1]]), np.array([(0, 1), (0, 2)]), 0.02)
    assert not placement.scales[0].any() and placement.scales[1, 2] == 1.0
    assert all(np.isfinite(a).all() for a in (placement.positions, placement.rotations, placement.scales))


def test_the_bone_is_a_closed_surface_that_faces_outwards():
    mesh = unit_bone()
    edges = {(a, b) for face in mesh.faces.tolist() for a, b in zip(face, face[1:] + face[:1], strict=True)}
    assert {(b, a) for a, b in edges} == edges
    corners = mesh.vertices[mesh.faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0
    assert volume > 0.5


def test_arrows_are_as_long_as_the_force():
    origins = np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 0.0], [np.nan, 0.0, 0.0]])
    forces = np.array([[0.0, 30.0, 400.0], [0.0, 0.0, 5.0], [0.0, 0.0, 300.0]])
    arrows = force_arrows(origins, forces, 0.001)
    assert arrows == pytest.approx(np.array([[[1.0, 2.0, 0.0], [1.0, 2.03, 0.4]]]))


def test_walking_direction_ignores_gaps_and_height():
    pelvis = np.array([[np.nan, 0, 0], [0, 0, 1.0], [0, -2.0, 0.5]])
    assert walking_direction(pelvis) == pytest.approx([0, -1, 0])
    assert walking_direction(np.zeros((3, 3))) == pytest.approx([1, 0, 0])


def test_presets_look_from_the_right_and_from_ahead():
    points, forward = np.array([[0.0, 0, 0], [0, 0, 1.6]]), np.array([0.0, 1.0, 0.0])
    found = cameras(points, forward, 3.0)
    assert found["sagittal"].position[0] == pytest.approx(3.0) and found["frontal"].position[1] == pytest.approx(3.0)
    assert found["sagittal"].target == pytest.approx([0, 0, 0.8])
