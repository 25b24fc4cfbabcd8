"""A prediction in the form of the result document."""

import numpy as np

from ..clinical.prediction_document import PathStep, PredictionEntry
from ..transcription.mechanical_problem import MechanicalProblem
from ..walking.model import ROOT
from ..walking.prediction import Prediction, PredictionStep
from ..walking.quantities import QUANTITIES
from ..walking.request import Request
from .prediction_source import PredictionSource

ASSUMPTIONS = (
    "The weights of the criteria, in the criteria's own units, are those of the identified gait; the cost is counted "
    "per distance walked.",
    "What the criteria do not explain is kept as a constant pull: the prices of the states that the identification "
    "was given. Changes of these prices by the new body or task are not foreseen.",
    "Springs hold the posture at these instants: twice the weakest that make the identified gait an optimum. "
    "Excursions of hips, knees, ankles and pelvic rotation may grow with the length of the stride at no cost.",
    "Order and relative duration of the contacts within the stride are those of the identified gait. Places of the "
    "feet, ground forces and, unless set, stride time and length are free; the stride ends as it began.",
    "The stride time is held as firmly as the posture resists a change of stride length at given speed, so that step "
    "length and cadence share a change of speed.",
)

PEAKS = {name: quantity for name, quantity in QUANTITIES.items() if quantity.kind == "torque"}


def prediction_entry(source: PredictionSource, request: Request, found: Prediction, seconds: float) -> PredictionEntry:
    """The prediction for `result.json`; `seconds` is the time that it took [s]."""
    last = found.steps[-1]
    return PredictionEntry(
        source=source.name,
        request=dict(request.values),
        units={name: QUANTITIES[name].unit for name in request.values},
        reached={name: _reached(request, name, last.share) for name in request.values},
        status="solved" if found.is_complete else "not_converged",
        message=found.reason,
        path=[_step(step) for step in found.steps],
        habit=found.habit.angle,
        identified=_key_numbers(found.steps[0]),
        predicted=_key_numbers(last),
        seconds=seconds,
        assumptions=list(ASSUMPTIONS),
    )


def _reached(request: Request, name: str, share: float) -> float:
    old = request.present.value(QUANTITIES[name])
    return old + share * (request.values[name] - old)


def _step(step: PredictionStep) -> PathStep:
    return PathStep(
        share=step.share,
        speed_m_per_s=step.length / step.time,
        step_length_m=0.5 * step.length,
        cadence_steps_per_min=120.0 / step.time,
        kkt_residual=step.residual,
        reduced_hessian="positive definite" if step.point.is_minimum() else "not positive definite",
        iterations=step.point.solution.iterations,
        jump=step.jump,
    )


def _key_numbers(step: PredictionStep) -> dict[str, float]:
    point = step.point
    problem = point.family.mechanical(point.situation, point.outer.log_time)
    return {
        "speed_m_per_s": step.length / step.time,
        "step_length_m": 0.5 * step.length,
        "cadence_steps_per_min": 120.0 / step.time,
    } | peak_torques(problem, point.solution.w, point.situation.subject.mass)


def peak_torques(problem: MechanicalProblem, w: np.ndarray, mass: float) -> dict[str, float]:
    """Largest active torque of each muscle group [N*m/kg] at w, shape (n_w,), for a body mass [kg]."""
    outputs = problem.outputs(w)
    joints = outputs[:, ROOT:]
    return {
        f"{name.removesuffix('_limit')}_peak_nm_per_kg": float(np.max(q.sign * joints[:, q.coordinate - ROOT])) / mass
        for name, q in PEAKS.items()
    }
