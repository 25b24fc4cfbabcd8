import numpy as np
import pytest

from gaitlab.multibody.anthropometry import CORRECTED, PRINTED, TABLES, total_mass_fraction
from gaitlab.multibody.rigid_body import RigidBody, welded
from gaitlab.multibody.upper_body import pelvis_body, shape_from_height, trunk_body


@pytest.mark.parametrize("name", ["corrected", "de_leva_male", "de_leva_female"])
def test_masses_add_up_to_the_body(name):
    assert total_mass_fraction(TABLES[name]) == pytest.approx(1.0, abs=1.5e-4)  # female: printed to four digits


def test_printed_masses_add_up_to_what_the_thesis_prints():
    assert total_mass_fraction(PRINTED) == pytest.approx(0.9604)


def test_centre_of_mass_of_a_standing_man():
    """Upright men: about 0.56 of the stature (Winter 2009, ch. 4: 0.54 to 0.57)."""
    shape = shape_from_height(CORRECTED, 1.0)
    hips = sum(CORRECTED[name].length for name in ("thigh", "shank")) + 0.039
    pelvis, trunk = pelvis_body(CORRECTED, shape, 1.0), trunk_body(CORRECTED, shape, 1.0)
    height = pelvis.mass * (hips + pelvis.centre_of_mass[2])
    height += trunk.mass * (hips + shape.lengths["pelvis"] + trunk.centre_of_mass[2])
    for name, top in (("thigh", hips), ("shank", hips - CORRECTED["thigh"].length), ("foot", 0.02)):
        drop = 0.0 if name == "foot" else CORRECTED[name].centre_of_mass * CORRECTED[name].length
        height += 2 * CORRECTED[name].mass * (top + drop)
    stature = hips + sum(shape.lengths[name] for name in ("pelvis", "trunk_middle", "trunk_upper", "head"))
    assert height / stature == pytest.approx(0.56, abs=0.01)


def test_welded_halves_of_a_rod_are_the_rod():
    """Rod of mass 2 and length 2 along z from its half rods: inertia m l^2 / 12."""
    half = RigidBody(mass=1.0, centre_of_mass=np.array([0, 0, 0.5]), inertia=np.diag([1, 1, 0]) / 12)
    down = half.seen_from(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
    rod = welded([half, down])
    np.testing.assert_allclose(rod.centre_of_mass, 0, atol=1e-15)
    np.testing.assert_allclose(rod.inertia, np.diag([2, 2, 0]) / 3, atol=1e-15)
