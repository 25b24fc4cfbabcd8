"""Issue 4, prediction: the identified gait comes back, and speed changes it as Schwartz et al. (2008) measured."""

import time
from collections.abc import Iterator

import numpy as np
from identified_demo import identified_demo
from registry import Row, measurement

from gaitlab.clinical.normative import ReferenceCohort, read_cohort
from gaitlab.errors import GaitlabError
from gaitlab.pipelines.prediction_entry import peak_torques
from gaitlab.pipelines.references import bundled_norms
from gaitlab.walking.prediction import Prediction, PredictionStep, predict
from gaitlab.walking.quantities import Present
from gaitlab.walking.request import parse_request

CHILDREN = ("demo_able_bodied_child", "demo_cp_child")
WRONG = (
    "happiness=1",
    "left_shank_length=3",
    "speed=0",
    "left_ankle_plantarflexor_limit=-5",
)


def predicted(child: str, *assignments: str) -> tuple[Prediction, float]:
    """The prediction and its seconds."""
    request = parse_request(assignments, Present(identified_demo(child)))
    begin = time.process_time()
    return predict(identified_demo(child), request.situation), time.process_time() - begin


def hip_extensor(step: PredictionStep) -> float:
    """Mean of both sides' peaks [N*m/kg]."""
    point = step.point
    problem = point.family.mechanical(point.situation, point.outer.log_time)
    peaks = peak_torques(problem, point.solution.w, point.situation.subject.mass)
    return 0.5 * sum(peaks[f"{side}_hip_extensor_peak_nm_per_kg"] for side in ("left", "right"))


@measurement(issue=4, line=5)
def unchanged_prediction() -> Iterator[Row]:
    for child in CHILDREN:
        gait = identified_demo(child)
        found, seconds = predicted(child)
        states = gait.problem.states(found.steps[-1].point.solution.w)
        apart = float(np.abs(states - gait.states).max())
        yield Row(quantity="largest change of a state", value=apart, limit="<= 1e-6", unit="", subject=child)
        yield Row(quantity="processor time", value=seconds, limit="", unit="s", subject=child)


@measurement(issue=4, line=5)
def faster_prediction() -> Iterator[Row]:
    """Speed +20 %: changes in percent, in the direction of the children of Schwartz et al. from free to fast."""
    cohort = read_cohort(bundled_norms())
    yield from _measured_children(cohort)
    for child in CHILDREN:
        found, seconds = predicted(child, "speed=+20%")
        first, last = found.steps[0], found.steps[-1]
        changes = {
            "cadence": first.time / last.time,
            "step length": last.length / first.length,
            "peak hip extensor moment": hip_extensor(last) / hip_extensor(first),
        }
        yield Row(quantity="share of the way", value=last.share, limit=">= 1", unit="", subject=child)
        for name, factor in changes.items():
            yield Row(quantity=name, value=100.0 * (factor - 1.0), limit=">= 0.5", unit="%", subject=child)
        residual = max(step.residual for step in found.steps)
        certified = min(float(step.is_certified) for step in found.steps)
        yield Row(quantity="largest KKT residual", value=residual, limit="<= 1e-6", unit="", subject=child)
        yield Row(quantity="every step a minimum", value=certified, limit=">= 1", unit="", subject=child)
        yield Row(quantity="steps", value=len(found.steps) - 1, limit="", unit="", subject=child)
        yield Row(quantity="processor time", value=seconds, limit="", unit="s", subject=child)


def _measured_children(cohort: ReferenceCohort) -> Iterator[Row]:
    bins = {bin.name: bin for bin in cohort.bins}
    free, fast = bins["free"], bins["fast"]
    who = "Schwartz 2008, free to fast"
    for name in ("speed", "cadence", "step_length"):
        change = 100.0 * (fast.normalised[name].mean / free.normalised[name].mean - 1.0)
        yield Row(quantity=name.replace("_", " "), value=change, limit=">= 0.5", unit="%", subject=who)
    peaks = [float(np.max(bin.kinetics["hip_extensor_moment"].mean)) for bin in (free, fast)]
    change = 100.0 * (peaks[1] / peaks[0] - 1.0)
    yield Row(quantity="peak hip extensor moment", value=change, limit=">= 0.5", unit="%", subject=who)


@measurement(issue=4, line=6)
def wrong_predictions() -> Iterator[Row]:
    present = Present(identified_demo(CHILDREN[0]))
    for text in WRONG:
        try:
            parse_request([text], present)
            refused = 0.0
        except GaitlabError:
            refused = 1.0
        yield Row(quantity=f"--set {text} refused", value=refused, limit=">= 1", unit="", subject=CHILDREN[0])
