from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from gaitlab.benchmarks.one_mass_oscillator import one_mass_oscillator
from gaitlab.errors import ProblemError
from gaitlab.ocp.extremal import power_of_p_norm


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x0": np.zeros(3)}, "x0"),
        ({"lower": np.zeros(2)}, "lower"),
        ({"outputs": ca.SX(0, 1)}, "at least one output"),
        ({"duration": 0.0}, "duration"),
        ({"lower": np.array([20.0])}, "cross"),
    ],
)
def test_malformed_problems_say_what_is_wrong(change, message):
    with pytest.raises(ProblemError, match=message):
        replace(one_mass_oscillator(), **change)


def test_power_of_p_norm():
    assert float(ca.evalf(power_of_p_norm(ca.SX([2.0, -1.0]), 8))) == 257.0


@pytest.mark.parametrize("exponent", [0, 7])
def test_odd_exponents_are_refused(exponent):
    with pytest.raises(ProblemError, match="even"):
        power_of_p_norm(ca.SX.sym("h", 2), exponent)
