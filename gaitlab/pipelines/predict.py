"""From the result of an analysis and a request to the result of a prediction, in the same form."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import msgspec
import numpy as np

from ..clinical.document import CalibrationEntry, Document
from ..inverse.conventional import joint_kinematics
from ..inverse.leg_kinetics import KineticsSettings
from ..walking.identified_gait import IdentifiedGait
from ..walking.prediction import Prediction, PredictionSettings, PredictionStep, predict
from ..walking.quantities import Present
from ..walking.request import parse_request
from .documents import Session, document_of
from .kinetics import trial_kinetics
from .model import whole_model_motion
from .optimal_arrays import ModelledStride, modelled_arrays, spread
from .prediction_entry import prediction_entry
from .prediction_source import PredictionSource
from .progress import Progress, Step
from .references import ReferenceOptions, load_references
from .repeated_stride import RATE, RepeatedStride
from .trial import Cycles, TrialAnalysis, cycle_curves, full_cycles, trial_spatiotemporal
from .walk_arrays import TIPS, bones, skeleton, support_phases


@dataclass(frozen=True, kw_only=True)
class PredictedWalk:
    """A prediction and its result."""

    prediction: Prediction
    trial: TrialAnalysis
    """The predicted gait as if it had been recorded and analysed."""
    document: Document


def predict_walk(
    source: PredictionSource,
    assignments: Sequence[str],
    progress: Progress,
    settings: PredictionSettings | None = None,
) -> PredictedWalk:
    """Solve for the new gait of a changed body or task.

    Args:
        source: The identified gait and its result.
        assignments: `name=value` of `quantities.QUANTITIES`; none: the identified gait itself.
        progress: Called at every step; may raise `Cancelled`.
        settings: Of the continuation.

    Raises:
        GaitlabError: the request is wrong, or the identified gait is no strict minimum.
    """
    request = parse_request(assignments, Present(source.gait))
    if not request.values:
        settings = replace(settings or PredictionSettings(), first_step=1.0)
    begin = perf_counter()

    def tell(share: float, _steps: int) -> None:
        progress(Step(stage="continuation from the identified gait", trial=source.name, done=share))

    found = predict(source.gait, request.situation, settings, tell)
    seconds = perf_counter() - begin
    progress(Step(stage="angles and moments of the predicted gait", trial=source.name))
    last = found.steps[-1]
    walk = RepeatedStride(_modelled(source, last), source.gait.heading)
    trial = replace(_analysed(source, walk), arrays=_arrays(source.gait, walk, found))
    entry = prediction_entry(source, request, found, seconds)
    document = document_of(_session(source, trial), [trial], source.document.weights)
    document = msgspec.structs.replace(document, prediction=entry, warnings=[*document.warnings, *_warnings(found)])
    return PredictedWalk(prediction=found, trial=trial, document=document)


def _warnings(found: Prediction) -> list[str]:
    return ([found.reason] if found.reason else []) + (
        ["the path jumps to another optimum on its way; the prediction is one of several gaits"]
        if any(step.jump for step in found.steps)
        else []
    )


def _modelled(source: PredictionSource, step: PredictionStep) -> ModelledStride:
    point, stride = step.point, source.gait.stride
    times = (stride.times - stride.times[0]) * (step.time / source.gait.duration)
    return ModelledStride(
        subject=point.situation.subject,
        times=times,
        floor=stride.floor,
        problem=point.family.mechanical(point.situation, point.outer.log_time),
        w=point.solution.w,
        criteria=source.gait.criteria,
    )


def _analysed(source: PredictionSource, walk: RepeatedStride) -> TrialAnalysis:
    subject = walk.stride.subject
    recording = walk.recording(source.name, _parameters(source, walk))
    kinematics = joint_kinematics(recording, source.calibration)
    every, _ = full_cycles(recording, walk.events)
    middle = (walk.duration - 1e-6, 2.0 * walk.duration - 1e-6)
    cycles: Cycles = {
        side: tuple(c for c in found if middle[0] <= c.start < middle[1]) for side, found in every.items()
    }
    kinetics = trial_kinetics(
        recording, kinematics, subject, (walk.events, cycles), KineticsSettings(), contacts=walk.contacts
    )
    entry = source.document.quality.calibration or CalibrationEntry(used="", computed={}, stored={})
    return TrialAnalysis(
        recording=recording,
        gaps=(),
        events=walk.events,
        cycles=cycles,
        calibration=entry,
        constants=source.calibration,
        kinematics=kinematics,
        curves=cycle_curves(kinematics, cycles, RATE),
        spatiotemporal=trial_spatiotemporal(recording, kinematics, cycles),
        subject=subject,
        motion=whole_model_motion(subject, recording, kinematics),
        kinetics=kinetics,
        weights=None,
        arrays={},
        warnings=(),
    )


def _parameters(source: PredictionSource, walk: RepeatedStride) -> dict[str, float]:
    """Body parameters of the source, mass and leg lengths as changed."""
    old, new = source.gait.stride.subject, walk.stride.subject
    parameters = dict(source.document.subject.parameters)
    if "mass" in parameters:
        parameters["mass"] *= new.mass / old.mass
    for side in ("left", "right"):
        name = f"{side}_leg_length"
        if name in parameters:
            parameters[name] += sum(
                float(np.linalg.norm(b.joint_offset) - np.linalg.norm(a.joint_offset))
                for a, b in zip(old.segments, new.segments, strict=True)
                if a.name in (f"{side}_shank", f"{side}_foot")
            )
    return parameters


def _session(source: PredictionSource, trial: TrialAnalysis) -> Session:
    return Session(
        static=None,
        parameters=trial.recording.parameters,
        assumed=tuple(source.document.subject.assumed),
        settings=source.document.settings,
        warnings=(),
        references=load_references(ReferenceOptions()),
    )


def _arrays(gait: IdentifiedGait, walk: RepeatedStride, found: Prediction) -> dict[str, np.ndarray]:
    """Contents of walk.npz: the predicted stride, and the measured one at the same share of its stride beside it."""
    subject, heading = walk.stride.subject, walk.heading
    time = np.arange(walk.n_frames) / RATE
    shown = ModelledStride(
        subject=subject,
        times=walk.stride.times + walk.duration,
        floor=walk.stride.floor,
        problem=walk.stride.problem,
        w=walk.stride.w,
        criteria=walk.stride.criteria,
    )
    predicted = modelled_arrays(shown, time, heading)
    inside = np.isfinite(predicted["q_optimal"][:, 0])
    phase = np.clip((time[inside] - walk.duration) / walk.duration, 0.0, 1.0)
    beside = ModelledStride(
        subject=gait.stride.subject,
        times=np.asarray(gait.stride.times),
        floor=gait.stride.floor,
        problem=gait.problem,
        w=gait.solution.w,
        criteria=gait.criteria,
    )
    measured = beside.coordinates(gait.stride.reference, gait.stride.times[0] + phase * gait.duration)
    # Beside each other, not one running ahead of the other.
    measured[:, 0] += predicted["q_optimal"][inside, 0] - measured[:, 0]
    return predicted | {
        "time": time,
        "q_measured": spread(measured, inside),
        "segment_names": np.array([segment.name for segment in subject.segments] + list(TIPS)),
        "segment_positions_measured": spread(skeleton(gait.stride.subject, measured, heading), inside),
        "bones": bones(subject),
        "phase": support_phases(walk.events, time),
        "path_share": np.array([step.share for step in found.steps]),
        "path_stride_time": np.array([step.time for step in found.steps]),
        "path_stride_length": np.array([step.length for step in found.steps]),
        "path_coordinates": np.stack(
            [gait.problem.states(step.point.solution.w)[:, : subject.n_q] for step in found.steps]
        ),
    }
