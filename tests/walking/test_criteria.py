"""Criteria against the formulas of the thesis, written out by hand."""

import casadi as ca
import numpy as np
import pytest

from gaitlab.errors import NotFound
from gaitlab.walking.criteria import ALL, THESIS, WalkState, by_name

MASS = 40.0
JOINTS = [f"{side}_{joint}_{axis}" for side in "rl" for joint in ("hip", "knee", "ankle") for axis in "yxz"]
"""Order of q[6:]: y flexion, x ab/adduction, z rotation."""


@pytest.fixture
def numbers():
    generator = np.random.default_rng(2)
    torques, velocities = generator.normal(0, 30, size=18), generator.normal(size=18)
    return {"tau": torques, "v": velocities, "lateral_offsets": np.array([0.03, -0.07]), "stance": np.array([1.0, 0.0])}


def value(name, numbers):
    symbols = {key: ca.SX.sym(key, len(array)) for key, array in numbers.items()}
    expression = by_name(name).expression(WalkState(mass=ca.SX(MASS), **symbols))
    return float(ca.Function("f", list(symbols.values()), [expression])(*numbers.values()))


def torque(numbers, joint):
    return numbers["tau"][JOINTS.index(joint)]


EXPECTED = {
    "lateral_stability": lambda n: 0.03**2,
    "torque": lambda n: sum(t**2 for t in n["tau"]),
    "hip_adduction_torque": lambda n: torque(n, "r_hip_x") ** 2 + torque(n, "l_hip_x") ** 2,
    "hip_rotation_torque": lambda n: torque(n, "r_hip_z") ** 2 + torque(n, "l_hip_z") ** 2,
    "peak_joint_moment": lambda n: sum((t / MASS) ** 8 for t in n["tau"]),
    "mechanical_power": lambda n: sum((t * v) ** 2 for t, v in zip(n["tau"], n["v"], strict=True)),
}


@pytest.mark.parametrize("name", ALL)
def test_formulas(name, numbers):
    assert value(name, numbers) == pytest.approx(EXPECTED[name](numbers), rel=1e-12)


def test_lateral_stability_counts_standing_feet(numbers):
    assert value("lateral_stability", numbers | {"stance": np.ones(2)}) == pytest.approx(0.03**2 + 0.07**2)
    assert value("lateral_stability", numbers | {"stance": np.zeros(2)}) == 0.0


def test_the_default_set_is_that_of_the_thesis():
    assert THESIS == ("lateral_stability", "torque", "hip_adduction_torque", "hip_rotation_torque")
    assert all("Hatz 2014, (12.3" in ALL[name].source for name in THESIS)


def test_criteria_know_their_names():
    assert all(criterion.name == name and criterion.title for name, criterion in ALL.items())
    with pytest.raises(NotFound, match=r"'effort'.*torque"):
        by_name("effort")
