"""Issue 2, line 3, from inside: tracking, certificate and fit of each child's strides, and the fit on an unseen one."""

import time
from collections.abc import Iterator
from math import inf

from demo_stride import request_of
from registry import CHILDREN, SHARED_DATA, Row, measurement

from gaitlab.bilevel.result import rms
from gaitlab.errors import NotConverged
from gaitlab.multibody.dynamics import layout_of
from gaitlab.nlp.sparse_solution import Status
from gaitlab.nlp.workers import Workers, usable_processors
from gaitlab.pipelines.analyse import Sources, analyse_files
from gaitlab.pipelines.options import AnalysisOptions
from gaitlab.pipelines.weights import WeightsRequest, usable_strides
from gaitlab.walking.explanation import Explanation, explain_tracked
from gaitlab.walking.model import walking_functions
from gaitlab.walking.tracking import MeasuredStride, track


@measurement(issue=2, line=3)
def explained_strides_of_children() -> Iterator[Row]:
    for child in CHILDREN:
        yield from explained_strides(child)


def explained_strides(child: str) -> Iterator[Row]:
    """Rows of one child's straight walk: its most central stride, and the weights of that on the next usable one."""
    strides = usable_strides(_request(child))[0]
    walking_functions(layout_of(strides[0][1].subject))  # compiled before the clock starts
    with Workers(usable_processors()) as workers:
        yield from _both_strides(child, [stride for _, stride in strides[:2]], workers)
    yield Row(quantity="usable strides", value=len(strides), limit="", unit="", subject=child)


def _both_strides(child: str, strides: list[MeasuredStride], workers: Workers) -> Iterator[Row]:
    found = []
    for number, stride in enumerate(strides, start=1):
        subject = f"{child}, stride {number}"
        try:
            explanation, seconds = _explain(stride, workers)
        except NotConverged:
            yield Row(quantity="not solved", value=1.0, limit="<= 0", unit="", subject=subject)
            continue
        found.append(explanation)
        yield from _certificate(subject, explanation, seconds)
        yield from _beside_others(subject, explanation.estimate.rms, explanation, "")
    if len(found) > 1:
        seen, unseen = found
        yield from _beside_others(f"{child}, stride 2", _fit_on(unseen, seen), unseen, ", weights of stride 1")


def _request(child: str) -> WeightsRequest:
    folder = SHARED_DATA / "children" / child
    static, walk = (next(folder.glob(f"{kind}_*.c3d")) for kind in ("static", "straight"))
    trial = analyse_files(Sources(walks=(walk,), static=static), AnalysisOptions(weights=False)).trials[0]
    return request_of(trial)


def _explain(stride: MeasuredStride, workers: Workers) -> tuple[Explanation, tuple[float, float]]:
    """The explanation, and the seconds for tracking and for the weights."""
    start = time.perf_counter()
    tracked = track(stride)
    middle = time.perf_counter()
    if tracked.solution.status is not Status.SOLVED:
        raise NotConverged(f"tracking: {tracked.solution.status.value}")
    explanation = explain_tracked(tracked, workers=workers)
    return explanation, (middle - start, time.perf_counter() - middle)


def _certificate(subject: str, found: Explanation, seconds: tuple[float, float]) -> Iterator[Row]:
    kkt = found.optimum.solution.residuals.max()
    minimum = float(found.optimum.sensitivity.is_minimum())
    converged = float(found.estimate.converged)
    yield Row(quantity="tracking", value=found.tracked.rms, limit="<= 0.03", unit="rad", subject=subject)
    yield Row(quantity="KKT residual", value=kkt, limit="<= 1e-6", unit="", subject=subject)
    yield Row(quantity="reduced Hessian positive definite", value=minimum, limit=">= 1", unit="", subject=subject)
    yield Row(quantity="upper level converged", value=converged, limit=">= 1", unit="", subject=subject)
    yield Row(quantity="tracking time", value=seconds[0], limit="<= 10", unit="s", subject=subject)
    yield Row(quantity="weights time", value=seconds[1], limit="<= 60", unit="s", subject=subject)
    for name, weight in zip(found.level.settings.criteria, found.estimate.theta, strict=True):
        yield Row(quantity=f"weight of {name}", value=float(weight), limit="", unit="", subject=subject)


def _beside_others(subject: str, fit: float, found: Explanation, whose: str) -> Iterator[Row]:
    """A fit on one stride, and how much better it is than that of equal weights and of each criterion alone there."""
    yield Row(quantity=f"fit{whose}", value=fit, limit="<= 0.06", unit="rad", subject=subject)
    for name, other in {"equal weights": found.equal_rms, **found.single_rms}.items():
        if other is None:
            yield Row(quantity=f"{name} alone not solved", value=1.0, limit="", unit="", subject=subject)
        else:
            quantity = f"fit{whose} minus that of {name}"
            yield Row(quantity=quantity, value=fit - other, limit="<= 0", unit="rad", subject=subject)


def _fit_on(unseen: Explanation, seen: Explanation) -> float:
    """Fit of one stride's weights on another; infinite where that is not solved [rad]."""
    theta = seen.estimate.theta
    response = unseen.level.respond(theta, unseen.optimum.predict(theta - unseen.estimate.theta))
    return rms(response.residual) if response.solution.status is Status.SOLVED else inf
