"""Where the states of the body are given to the lower level."""

import numpy as np
import pytest

from gaitlab.ocp.mechanical import ContactStage
from gaitlab.walking.identification import arc_boundaries

RIGHT, LEFT, BOTH = (0, 1, 2, 3, 4, 5), (6, 7, 8, 9, 10, 11), tuple(range(12))
RIGHT_HEEL = (0, 1, 2)


def stage(active, n_intervals, duration):
    return ContactStage(
        duration=duration,
        n_intervals=n_intervals,
        active=active,
        landing=(),
        grounded=(),
        clear=(),
        force_cone=np.zeros((0, 12)),
        data=np.zeros(2),
    )


def test_ends_and_changes_between_stance_and_swing_are_given():
    stages = (stage(BOTH, 4, 0.1), stage(LEFT, 10, 0.4), stage(BOTH, 3, 0.1))
    np.testing.assert_array_equal(arc_boundaries(stages, 1.0), [0, 4, 14, 17])


def test_rolling_of_a_foot_is_no_boundary():
    stages = (stage(RIGHT_HEEL, 4, 0.1), stage(RIGHT, 6, 0.2), stage(BOTH, 3, 0.1))
    np.testing.assert_array_equal(arc_boundaries(stages, 1.0), [0, 10, 13])


def test_long_arcs_are_cut_evenly():
    np.testing.assert_array_equal(arc_boundaries((stage(RIGHT, 12, 0.36),), 0.12), [0, 4, 8, 12])


@pytest.mark.parametrize("longest", [0.06, 0.12, 0.2])
def test_no_arc_is_much_longer_than_asked(longest):
    """At most by the half interval on each side that rounding to nodes costs."""
    stages = (stage(BOTH, 5, 0.11), stage(LEFT, 17, 0.43), stage(BOTH, 6, 0.13), stage(RIGHT, 16, 0.41))
    lengths = np.concatenate([np.full(s.n_intervals, s.duration / s.n_intervals) for s in stages])
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    nodes = arc_boundaries(stages, longest)
    assert np.diff(times[nodes]).max() <= longest + lengths.max()
    assert np.all(np.diff(nodes) > 0)
