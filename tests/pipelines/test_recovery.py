"""The inverse problem against walks of known weights, which another grid and another integrator made.

First from the C3D files alone. Then with the states between arcs, the normalisers and the floors of the truth, where
durations, contacts and the motion within the arcs are all that the search for the weights sees.
"""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from demo_stride import demo_request, noisy_demo_request, true_weights

from gaitlab.bilevel.implicit_gauss_newton import ImplicitGaussNewton
from gaitlab.bilevel.result import rms
from gaitlab.bilevel.uncertainty import ellipsoid_holds
from gaitlab.pipelines.bundled import DEMO_CHILDREN, demo_folder
from gaitlab.pipelines.demo_data import WALKS
from gaitlab.pipelines.demo_patterns import GRID, demo_patterns
from gaitlab.pipelines.demo_subject import demo_subject
from gaitlab.pipelines.demo_tracking import pattern_stages
from gaitlab.pipelines.weights import frames_of, usable_strides
from gaitlab.walking.arcs import part_of_stages
from gaitlab.walking.explanation import ExplanationSettings, explain
from gaitlab.walking.identification import IdentificationSettings, WalkLevel, arc_boundaries
from gaitlab.walking.tracking import measured_stride, track

pytestmark = pytest.mark.slow

CLOSE = 0.02


def recorded(child, walk):
    """Truth of a walk and its right stride as recorded without error."""
    truth = json.loads((demo_folder(child) / "truth.json").read_text())["walks"][walk]
    (pattern,) = (p.paced(*WALKS[child][walk]) for p in demo_patterns() if p.name == child)
    start, end = truth["optimal_stride_s"]
    stages = part_of_stages(pattern_stages(pattern, GRID), round(start / GRID), round(end / GRID))
    stride = measured_stride(demo_subject(pattern).model, stages, start, np.array(truth["q"]), truth["rate_hz"])
    return truth, stride


def level_of(truth, stride):
    """The lower level with everything given as it was."""
    tracked = track(stride)
    states = tracked.states.copy()
    nodes = arc_boundaries(stride.stages, IdentificationSettings().longest_arc)
    states[nodes] = [*(arc["state"] for arc in truth["arcs"]), truth["end_state"]]
    w = tracked.solution.w.copy()
    w[: states.size] = states.ravel()
    level = WalkLevel(replace(tracked, solution=replace(tracked.solution, w=w)), IdentificationSettings())
    level.all_normalisers[level.indices] = truth["normalisers"]
    level.normalisers = np.array(truth["normalisers"])
    level.acceleration_normaliser = truth["floors"]["acceleration_normaliser"]
    return level


def explained(request):
    _, stride = usable_strides(request)[0][0]
    found = explain(stride, ExplanationSettings(single_criteria=False), frames=partial(frames_of, request, stride))
    assert found.states_estimated
    return found


@pytest.mark.parametrize("child", DEMO_CHILDREN)
def test_known_weights_come_back_from_the_recording(child):
    found = explained(demo_request(child))
    assert found.is_certified
    np.testing.assert_allclose(found.estimate.theta, true_weights(child), atol=CLOSE)


def test_the_ellipsoid_holds_the_truth_where_markers_are_noisy():
    """One seed; forty are counted by benchmarks/issue2_recovery.py."""
    child = DEMO_CHILDREN[0]
    estimate = explained(noisy_demo_request(child, seed=0, noise=5e-4)).estimate
    assert ellipsoid_holds(estimate.theta - true_weights(child), estimate.covariance)
    assert np.sqrt(np.diag(estimate.covariance)).max() < 0.05


@pytest.mark.parametrize("walk", ["walk1", "walk2"])
@pytest.mark.parametrize("child", DEMO_CHILDREN)
def test_known_weights_come_back(child, walk):
    truth, stride = recorded(child, walk)
    level = level_of(truth, stride)
    equal = np.full(level.n_theta, 1.0 / level.n_theta)
    found = ImplicitGaussNewton().solve(level, equal, level.from_tracking(equal))
    assert found.converged
    assert rms(found.response.residual) < 0.003
    np.testing.assert_allclose(found.theta, truth["weights"], atol=CLOSE)
    assert np.abs(equal - truth["weights"]).max() > 4 * CLOSE
