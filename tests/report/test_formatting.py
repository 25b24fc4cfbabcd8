import pytest

from gaitlab.report.formatting import label, plain, rows_of


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("step_length_m", "Step length [m]"),
        ("speed_m_per_s", "Speed [m/s]"),
        ("foot_off_percent", "Foot off [%]"),
        ("cadence_steps_per_min", "Cadence [steps/min]"),
        ("left_knee_extensor_peak_nm_per_kg", "Left knee extensor peak [N·m/kg]"),
        ("name", "Name"),
    ],
)
def test_a_key_is_read_with_its_unit(key, words):
    assert label(key) == words


@pytest.mark.parametrize(("value", "words"), [(None, "–"), (True, "yes"), (3, "3"), (0.123456, "0.1235"), ("x", "x")])
def test_values_are_short(value, words):
    assert plain(value) == words


def test_nested_values_become_rows():
    assert rows_of({"a": {"b_m": 1.5, "c": [1, 2]}, "d": []}) == [
        ("A / B [m]", "1.5"),
        ("A / C", "1, 2"),
        ("D", "none"),
    ]
