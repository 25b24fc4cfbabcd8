"""A bundled demo stride followed from equal weights to more stability."""

import numpy as np
import pytest
from demo_stride import demo_stride

from gaitlab.walking.identification import IdentificationSettings, WalkLevel
from gaitlab.walking.tracking import track
from gaitlab.walking.what_if import WhatIf, gait_curves, with_weight

pytestmark = pytest.mark.slow

EQUAL = np.full(4, 0.25)


@pytest.fixture(scope="module")
def sweep():
    level = WalkLevel(track(demo_stride()), IdentificationSettings())
    return WhatIf().sweep(level, (EQUAL, level.from_tracking(EQUAL)), with_weight(EQUAL, 0, 0.5), shares=(0.5,))


def test_every_walk_on_the_way_is_certified(sweep):
    assert sweep.is_complete, sweep.reason
    assert all(step.response.solution.is_optimal(1e-6) for step in sweep.steps)
    assert all(step.response.sensitivity.is_minimum() for step in sweep.steps)


def test_given_states_stay_and_the_rest_moves(sweep):
    level, curves = sweep.steps[0].response.level, gait_curves(sweep)
    moved = np.abs(curves - curves[0])
    assert moved[:, level.given_nodes].max() < 1e-6
    assert moved[-1].max() > 1e-3


def test_the_optimal_cost_is_concave_along_the_way(sweep):
    """Its slope is the way times the normalised criteria."""
    way, level = sweep.steps[-1].theta - EQUAL, sweep.steps[0].response.level
    slopes = [
        way @ (step.response.problem.criteria(step.response.solution.w)[level.indices] / level.normalisers)
        for step in sweep.steps
    ]
    assert np.all(np.diff(slopes) <= 1e-4)
