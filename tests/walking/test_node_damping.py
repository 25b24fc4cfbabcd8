"""Steps are held back where an arc surprised, and nowhere else."""

import numpy as np
import pytest

from gaitlab.walking.node_damping import EASED, HELD, MOST, NodeDamping, states_of_arcs

NONE = np.zeros(3, dtype=bool)
SECOND = np.array([False, True, False])


@pytest.fixture
def damping():
    return NodeDamping(scale=np.array([0.1, 2.0]), factors=np.ones(4), least=0.1)


def test_an_arc_has_two_states():
    np.testing.assert_array_equal(states_of_arcs(SECOND), [False, True, True, False])


def test_a_step_of_the_scale_costs_what_the_factor_says(damping):
    damping.factors = np.array([1.0, 2.0, 3.0, 4.0])
    step = np.tile(damping.scale, 4)
    assert step @ (damping.diagonal * step) == pytest.approx(2 * (1 + 2 + 3 + 4))


def test_states_of_surprising_arcs_are_held_back(damping):
    damping.hold(SECOND, 0)
    np.testing.assert_allclose(damping.factors, [1, HELD, HELD, 1])
    damping.hold(SECOND, 1)
    np.testing.assert_allclose(damping.factors, [1, HELD**3, HELD**3, 1])


def test_all_are_held_back_where_no_arc_surprised(damping):
    damping.hold(NONE, 0)
    np.testing.assert_allclose(damping.factors, HELD)


def test_all_are_held_back_where_states_that_stand_still_surprise(damping):
    damping.factors[1:3] = MOST
    damping.hold(SECOND, 0)
    np.testing.assert_allclose(damping.factors, [HELD, MOST, MOST, HELD])


def test_states_of_other_arcs_are_eased_as_far_as_the_least(damping):
    damping.ease(SECOND)
    np.testing.assert_allclose(damping.factors, [1 / EASED, 1, 1, 1 / EASED])
    damping.ease(SECOND)
    np.testing.assert_allclose(damping.factors, [0.1, 1, 1, 0.1])
