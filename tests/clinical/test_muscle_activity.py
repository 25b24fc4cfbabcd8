import numpy as np
import pytest

from gaitlab.clinical.muscle_activity import active_spans


def envelope(*spans, level=1.0, rest=0.05):
    values = np.full(101, rest)
    for start, end in spans:
        values[start:end] = level
    values[100] = values[0]
    return values


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (envelope((10, 30)), [(10.0, 30.0)]),
        (envelope((10, 30), (33, 50)), [(10.0, 50.0)]),  # a short pause does not end it
        (envelope((10, 30), (60, 63)), [(10.0, 30.0)]),  # a short burst is none
        (envelope((0, 12), (90, 101)), [(0.0, 12.0), (90.0, 100.0)]),
        (envelope((0, 3), (97, 101)), [(0.0, 3.0), (97.0, 100.0)]),  # 6 % over the end of the cycle
        (envelope((20, 40), rest=0.3), [(20.0, 40.0)]),  # above a resting level
        (envelope((20, 40), rest=0.4), []),  # too flat to judge
        (np.zeros(101), []),
    ],
)
def test_parts_of_the_cycle(values, expected):
    assert active_spans(values) == expected


def test_the_unit_does_not_matter():
    values = envelope((10, 30)) + 0.1 * np.sin(np.linspace(0.0, 6.0, 101))
    assert active_spans(1e-6 * np.abs(values)) == active_spans(np.abs(values))


def test_an_unknown_sample_makes_it_unknown():
    values = envelope((10, 30))
    values[50] = np.nan
    assert active_spans(values) == []
