import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.transcription.control_spline import ControlSpline

TIMES = np.linspace(0.0, 2.0, 41)


def test_cubics_without_slope_at_the_ends_are_met_exactly():
    spline, nodes = ControlSpline(n_nodes=6), np.linspace(0.0, 2.0, 6)
    values = [spline.matrix(2.0, 1, TIMES, order)[:, 0] @ (nodes**2 * (3.0 - nodes)) for order in range(3)]
    expected = TIMES**2 * (3.0 - TIMES), 3.0 * TIMES * (2.0 - TIMES), 6.0 - 6.0 * TIMES
    np.testing.assert_allclose(values, expected, atol=1e-12)


def test_controls_of_one_node_stand_together():
    spline, nodes = ControlSpline(n_nodes=5), np.arange(10.0).reshape(5, 2)
    np.testing.assert_allclose(spline.matrix(2.0, 2, np.linspace(0.0, 2.0, 5)) @ nodes.ravel(), nodes, atol=1e-12)


def test_too_few_nodes():
    with pytest.raises(ProblemError, match="at least 4"):
        ControlSpline(n_nodes=3)
