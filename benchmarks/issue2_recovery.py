"""Issue 2, line 4: the weights of the demo walks from their C3D files, without noise and with noise of many seeds."""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

import numpy as np
from demo_stride import demo_request, noisy_demo_request, true_weights
from registry import Row, measurement
from scipy.stats import binom

from gaitlab.bilevel.uncertainty import ellipsoid_holds
from gaitlab.errors import NotConverged
from gaitlab.pipelines.bundled import DEMO_CHILDREN
from gaitlab.pipelines.weights import frames_of, usable_strides
from gaitlab.walking.explanation import ExplanationSettings, explain

SEEDS, NOISE = 40, 5e-4  # m, of every marker coordinate
COVERED = 0.95
NOISY_CHILD = "demo_cp_child"
CASE = tuple[str, int | None]


@measurement(issue=2, line=4)
def weights_of_demo_walks_without_noise() -> Iterator[Row]:
    for child in DEMO_CHILDREN:
        error, _, _ = recovered((child, None))
        worst = float(np.abs(error).max())
        yield Row(quantity="largest error of a weight", value=worst, limit="<= 0.02", unit="", subject=child)


@measurement(issue=2, line=4)
def coverage_of_the_ellipsoid() -> Iterator[Row]:
    cases = [(NOISY_CHILD, seed) for seed in range(SEEDS)]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        found = list(pool.map(recovered, cases))
    inside = sum(held for _, held, _ in found)
    low, high = binom.interval(0.99, SEEDS, COVERED)
    subject = f"{NOISY_CHILD}, {SEEDS} seeds, {1000 * NOISE:g} mm"
    yield Row(quantity="covered", value=inside, limit=f">= {low:.0f}", unit="", subject=subject)
    yield Row(quantity="covered at most", value=inside, limit=f"<= {high:.0f}", unit="", subject=subject)
    errors = np.array([error for error, _, _ in found])
    sds = np.array([sd for _, _, sd in found])
    for name, value in (("error", np.abs(errors)), ("standard deviation", sds)):
        median = float(np.nanmedian(value))
        yield Row(quantity=f"median {name} of a weight", value=median, limit="", unit="", subject=subject)


def recovered(case: CASE) -> tuple[np.ndarray, bool, np.ndarray]:
    """Errors of the weights (4,), whether the 95 % ellipsoid holds the truth, and their standard deviations."""
    child, seed = case
    request = demo_request(child) if seed is None else noisy_demo_request(child, seed, NOISE)
    _, stride = usable_strides(request)[0][0]
    frames = partial(frames_of, request, stride)
    try:
        estimate = explain(stride, ExplanationSettings(single_criteria=False), frames=frames).estimate
    except NotConverged:
        return np.full(4, np.nan), False, np.full(4, np.nan)
    error = estimate.theta - true_weights(child)
    return error, ellipsoid_holds(error, estimate.covariance, COVERED), np.sqrt(np.diag(estimate.covariance))
