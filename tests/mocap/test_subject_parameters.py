import numpy as np
import pytest
from raw_file import raw_recording

from gaitlab.mocap.subject_parameters import file_parameters, subject_parameters


def read(software: str = "Vicon Nexus", group: str = "PROCESSING", **values: float):
    parameters = {
        group: {name.upper(): np.array([value]) for name, value in values.items()},
        "MANUFACTURER": {"SOFTWARE": (software,)},
    }
    return subject_parameters(raw_recording(parameters=parameters))


def test_nexus_units_become_si():
    found, warnings = read(Bodymass=32.1, Height=1450.0, LLegLength=740.0, RKneeWidth=84.0, LThighRotation=-0.3)
    assert found == pytest.approx(
        {"mass": 32.1, "height": 1.45, "left_leg_length": 0.74, "right_knee_width": 0.084, "left_thigh_rotation": -0.3}
    )
    assert warnings == ()


@pytest.mark.parametrize(("leg", "knee"), [(740.0, 84.0), (74.0, 8.4), (0.74, 0.084)])
def test_mm_cm_and_m(leg, knee):
    found, _ = read(LLegLength=leg, LKneeWidth=knee)
    assert found == pytest.approx({"left_leg_length": 0.74, "left_knee_width": 0.084})


@pytest.mark.parametrize(
    ("software", "stored"), [("Vicon Workstation", 1.5), ("Vicon Nexus", np.radians(1.5)), ("Other", np.radians(1.5))]
)
def test_angles_are_degrees_in_workstation_files(software, stored):
    found, _ = read(software=software, LStaticPlantFlex=stored)
    assert found["left_static_plantar_flexion"] == pytest.approx(np.radians(1.5))


def test_large_angles_of_unknown_software_are_degrees():
    found, _ = read(software="Other", LStaticPlantFlex=1.0, RStaticPlantFlex=12.0)
    assert found["left_static_plantar_flexion"] == pytest.approx(np.radians(1.0))


def test_patella_wands_of_nexus_stay_radians():
    assert read(LThighRotation=-1.741)[0]["left_thigh_rotation"] == pytest.approx(-1.741)


@pytest.mark.parametrize("mass", [0.0, -1.0, np.nan, 5000.0])
def test_impossible_values_are_not_used(mass):
    found, warnings = read(Bodymass=mass)
    assert "mass" not in found
    assert "BODYMASS" in warnings[0]


def test_zero_measurements_mean_not_measured():
    found, warnings = read(InterAsisDistance=0.0, LLegLength=0.0)
    assert found == {}
    assert len(warnings) == 2


def test_other_groups_and_spellings():
    found, _ = read(group="SUBJECTS", Left_Leg_Length=740.0, Mass=30.0)
    assert found == pytest.approx({"left_leg_length": 0.74, "mass": 30.0})


def test_what_is_written_is_read_back():
    values = {
        "mass": 30.0,
        "height": 1.3,
        "left_ankle_width": 0.06,
        "right_static_rotation": -0.04,
        "left_foot_flat": 1.0,
    }
    assert read("gaitlab", **file_parameters(values))[0] == pytest.approx(values)
