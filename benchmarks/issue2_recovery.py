"""Issue 2, line 4: the weights of the demo walks from their C3D files, without noise and with noise of many seeds."""

import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context

import numpy as np
from demo_stride import request_of
from registry import Row, measurement
from scipy.linalg import null_space
from scipy.stats import binom, chi2

from gaitlab.errors import NotConverged
from gaitlab.mocap.c3d import read_c3d
from gaitlab.pipelines.analyse import analyse
from gaitlab.pipelines.bundled import DEMO_CHILDREN, demo_folder
from gaitlab.pipelines.options import AnalysisOptions
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
    inside = sum(distance <= chi2.ppf(COVERED, 3) for _, distance, _ in found)
    low, high = binom.interval(0.99, SEEDS, COVERED)
    subject = f"{NOISY_CHILD}, {SEEDS} seeds, {1000 * NOISE:g} mm"
    yield Row(quantity="covered", value=inside, limit=f">= {low:.0f}", unit="", subject=subject)
    yield Row(quantity="covered at most", value=inside, limit=f"<= {high:.0f}", unit="", subject=subject)
    errors = np.array([error for error, _, _ in found])
    sds = np.array([sd for _, _, sd in found])
    for name, value in (("error", np.abs(errors)), ("standard deviation", sds)):
        median = float(np.nanmedian(value))
        yield Row(quantity=f"median {name} of a weight", value=median, limit="", unit="", subject=subject)


def recovered(case: CASE) -> tuple[np.ndarray, float, np.ndarray]:
    """Errors of the weights (4,), their squared distance from the truth in the covariance's metric, and their sds."""
    child, seed = case
    folder = demo_folder(child)
    truth = np.array(json.loads((folder / "truth.json").read_text())["walks"]["walk1"]["weights"])
    walk = read_c3d(folder / "walk1.c3d")
    if seed is not None:
        random = np.random.default_rng(seed)
        noisy = {name: y + NOISE * random.standard_normal(y.shape) for name, y in walk.markers.items()}
        walk = replace(walk, markers=noisy)
    trial = analyse(read_c3d(folder / "static.c3d"), [walk], AnalysisOptions(weights=False)).trials[0]
    request = request_of(trial)
    _, stride = usable_strides(request)[0][0]
    frames = partial(frames_of, request, stride)
    try:
        estimate = explain(stride, ExplanationSettings(single_criteria=False), frames=frames).estimate
    except NotConverged:
        return np.full(4, np.nan), np.inf, np.full(4, np.nan)
    error, tangent = estimate.theta - truth, null_space(np.ones((1, 4)))
    inner = tangent.T @ error
    distance = float(inner @ np.linalg.solve(tangent.T @ estimate.covariance @ tangent, inner))
    return error, distance, np.sqrt(np.diag(estimate.covariance))
