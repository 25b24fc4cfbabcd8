import numpy as np
import pytest

from gaitlab.report.svg import Axes, curve, number, text, thinned, ticks

AXES = Axes(left=10.0, top=20.0, width=100.0, height=50.0, x_range=(0.0, 10.0), y_range=(-1.0, 1.0))


def test_data_land_in_the_rectangle():
    assert (AXES.x(0.0), AXES.x(10.0)) == (10.0, 110.0)
    assert (AXES.y(1.0), AXES.y(-1.0)) == (20.0, 70.0)


def test_a_gap_interrupts_the_line():
    drawn = curve(AXES, np.arange(4.0), np.array([0.0, 0.0, np.nan, 0.0]))
    assert 'd="M10 45L20 45M40 45"' in drawn


def test_a_curve_of_gaps_draws_nothing():
    assert curve(AXES, np.arange(3.0), np.full(3, np.nan)) == ""


@pytest.mark.parametrize(("value", "written"), [(1.0, "1"), (1.25, "1.2"), (-0.04, "0"), (0.0, "0"), (-10.06, "-10.1")])
def test_coordinates_are_short(value, written):
    assert number(value) == written


def test_words_are_escaped():
    assert "&lt;b&gt;" in text("<b>", 0.0, 0.0)


@pytest.mark.parametrize(
    ("low", "high", "expected"), [(0.0, 1.0, [0, 0.2, 0.4, 0.6, 0.8, 1.0]), (-20, 40, [-20, -10, 0, 10, 20, 30, 40])]
)
def test_ticks_are_round(low, high, expected):
    assert ticks(low, high, 5) == pytest.approx(expected)


@pytest.mark.parametrize("high", [1.0, np.nan, 0.0])
def test_no_ticks_without_a_range(high):
    assert ticks(1.0, high) == []


def test_thinning_keeps_gaps():
    y = np.ones(600)
    y[101] = np.nan
    x, thin = thinned(np.arange(600.0), y)
    assert len(thin) == 150 and np.isnan(thin[25]) and np.isfinite(np.delete(thin, 25)).all() and x[25] == 100.0
