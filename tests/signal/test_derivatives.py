import numpy as np
import pytest

from gaitlab.signal.derivatives import derivative, second_derivative

RATE = 50.0
T = np.arange(40) / RATE


def test_derivatives_of_a_parabola_are_exact():
    x = np.column_stack([3.0 * T**2, -T])
    assert derivative(x, RATE) == pytest.approx(np.column_stack([6.0 * T, -np.ones_like(T)]))
    assert second_derivative(x, RATE) == pytest.approx(
        np.column_stack([np.full_like(T, 6.0), np.zeros_like(T)]), abs=1e-9
    )


def test_error_falls_with_the_square_of_the_step():
    errors = []
    for rate in (50.0, 100.0):
        t = np.arange(0.0, 1.0, 1.0 / rate)
        errors.append(np.abs(derivative(np.sin(5 * t), rate) - 5 * np.cos(5 * t)).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.15)


def test_no_difference_is_taken_across_a_gap():
    x = np.where(np.arange(40) < 20, 0.0, 100.0)
    x[20] = np.nan
    assert np.isnan(derivative(x, RATE)[20])
    assert derivative(x, RATE)[[19, 21]] == pytest.approx(0.0)
    assert second_derivative(x, RATE)[[19, 21]] == pytest.approx(0.0)


def test_a_lone_sample_has_no_derivative():
    assert np.isnan(derivative(np.array([np.nan, 1.0, np.nan]), RATE)).all()
