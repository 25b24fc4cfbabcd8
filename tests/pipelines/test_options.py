import pytest

from gaitlab.errors import InvalidSubject, NotFound, ProblemError
from gaitlab.pipelines.options import AnalysisOptions


def test_the_thesis_four_are_the_default_criteria():
    assert AnalysisOptions().criteria == (
        "lateral_stability",
        "torque",
        "hip_adduction_torque",
        "hip_rotation_torque",
    )


@pytest.mark.parametrize(("name", "value"), [("mass", 0.0), ("height", -1.5), ("left_knee_width", 100.0)])
def test_impossible_bodies_are_refused_with_the_range_and_unit(name, value):
    with pytest.raises(InvalidSubject, match=rf"{name} is .*: give a value from .* (kg|m)$"):
        AnalysisOptions(parameters={name: value})


def test_angles_may_be_negative():
    assert AnalysisOptions(parameters={"left_tibial_torsion": -0.3}).parameters


def test_unknown_names_are_refused_with_the_known_ones():
    with pytest.raises(NotFound, match="available: .*left_leg_length"):
        AnalysisOptions(parameters={"leg_length": 0.8})
    with pytest.raises(NotFound, match="available: .*torque"):
        AnalysisOptions(criteria=("happiness",))


def test_weights_need_a_criterion():
    with pytest.raises(ProblemError, match="--no-weights"):
        AnalysisOptions(criteria=())
    assert AnalysisOptions(criteria=(), weights=False)
