"""The main job: C3D files in; angles, events, model, walk and weights out."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

from ..clinical.document import CalibrationEntry, Document, WeightsEntry
from ..errors import InvalidRecording, NotConverged, WorkerLost
from ..inverse.conventional import ConventionalKinematics, KinematicsSettings, joint_kinematics
from ..inverse.conventional_calibration import Calibration
from ..inverse.kinematics import InverseKinematics
from ..inverse.leg_kinetics import KineticsSettings
from ..mocap.c3d import read_c3d
from ..mocap.recording import Event, Recording
from ..multibody.marker_set import SEGMENT_OF_MARKER
from ..multibody.scaling import SubjectSettings
from ..multibody.subject import SubjectModel
from ..signal.gaps import Gap, describe_gaps, fill_gaps
from .calibration import assumed_parameters, calibrate_walk
from .corrected_events import check_trials, events_to_use
from .documents import Session, document_of
from .kinetics import trial_kinetics
from .model import motion_warnings, person_model, single_frames, whole_model_motion
from .options import AnalysisOptions
from .pooling import combine_entries
from .progress import Progress, Step, silent
from .references import load_references
from .trial import TrialAnalysis, cycle_curves, full_cycles, trial_spatiotemporal
from .walk_arrays import measured_arrays
from .weights import TrialWeights, WeightsRequest, identify_weights


@dataclass(frozen=True, kw_only=True)
class Sources:
    """Files of one session of one person."""

    walks: tuple[Path, ...]
    static: Path | None = None


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """Everything that came out."""

    trials: tuple[TrialAnalysis, ...]
    documents: tuple[Document, ...]
    """One per trial."""
    document: Document
    """All trials together; with one trial its own."""
    not_converged: str
    """What was asked for and did not converge, in words; empty when all is well."""


def analyse_files(sources: Sources, options: AnalysisOptions, progress: Progress = silent) -> Analysis:
    """Read C3D files and analyse them.

    Raises:
        GaitlabError: Bad input; the message says what, where and what to do.
        Cancelled: `progress` asked to stop.
    """
    _check_names(sources)
    recordings: list[Recording] = []
    for path in (*([] if sources.static is None else [sources.static]), *sources.walks):
        progress(Step(stage="reading", trial=path.stem))
        recordings.append(read_c3d(path))
    static = None if sources.static is None else recordings[0]
    return analyse(static, recordings[len(recordings) - len(sources.walks) :], options, progress)


def _check_names(sources: Sources) -> None:
    if not sources.walks:
        raise InvalidRecording("no walking trial is given; name at least one C3D file")
    stems = [path.stem for path in sources.walks]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        raise InvalidRecording(f"two walks are called {twice[0]}; results are named after files, so rename one")


def analyse(
    static: Recording | None, walks: Sequence[Recording], options: AnalysisOptions, progress: Progress = silent
) -> Analysis:
    """Analyse recordings in memory; see `analyse_files`."""
    if static is not None:
        static = _filled(static, options)[0]
    check_trials(options.events, walks)
    prepared = [_prepare(static, walk, options, progress) for walk in walks]
    subject = _build_subject(static, prepared[0], options)
    trials = tuple(_analyse_walk(subject, walk, options, progress) for walk in prepared)
    session = _session(static, prepared[0], options)
    documents = tuple(document_of(session, [trial], _entry(trial)) for trial in trials)
    together = documents[0]
    if len(trials) > 1:
        entries = [entry for entry in map(_entry, trials) if entry is not None]
        together = document_of(session, trials, combine_entries(entries) if entries else None)
    failed = [f"{trial.name}: {trial.not_converged}" for trial in trials if trial.not_converged]
    return Analysis(trials=trials, documents=documents, document=together, not_converged="; ".join(failed))


@dataclass(frozen=True, kw_only=True)
class _Walk:
    """A walk with its direct kinematics."""

    recording: Recording
    gaps: tuple[Gap, ...]
    calibration: Calibration
    entry: CalibrationEntry
    kinematics: ConventionalKinematics


def _filled(recording: Recording, options: AnalysisOptions) -> tuple[Recording, tuple[Gap, ...]]:
    markers, gaps = fill_gaps(recording.markers, recording.rate, options.longest_gap)
    return replace(recording, markers=markers), gaps


def _prepare(static: Recording | None, walk: Recording, options: AnalysisOptions, progress: Progress) -> _Walk:
    progress(Step(stage="joint angles", trial=walk.name))
    recording, gaps = _filled(walk, options)
    calibration, entry = calibrate_walk(static, recording, options.parameters, options.static_offsets)
    kinematics = joint_kinematics(recording, calibration, KinematicsSettings(forward=options.forward))
    return _Walk(recording=recording, gaps=gaps, calibration=calibration, entry=entry, kinematics=kinematics)


def _analyse_walk(subject: SubjectModel, walk: _Walk, options: AnalysisOptions, progress: Progress) -> TrialAnalysis:
    recording, kinematics = walk.recording, walk.kinematics
    progress(Step(stage="events", trial=recording.name))
    events = events_to_use(recording, options.events, options.redetect_events)
    found, stride_warnings = full_cycles(recording, events)
    progress(Step(stage="whole-model kinematics", trial=recording.name))
    motion = whole_model_motion(subject, recording, kinematics)
    progress(Step(stage="kinetics", trial=recording.name))
    choices = KineticsSettings(frame=options.moment_frame, inertia=options.kinetics_inertia)
    kinetics = trial_kinetics(recording, kinematics, subject, (events, found), choices)
    arrays = measured_arrays(recording, events, subject, motion.q, kinematics.heading)
    weights, reason = None, ""
    if options.weights:
        weights, reason = _try_weights(_request(subject, walk, events, motion, options), progress)
    return TrialAnalysis(
        recording=recording,
        gaps=walk.gaps,
        events=events,
        cycles=found,
        calibration=walk.entry,
        constants=walk.calibration,
        kinematics=kinematics,
        curves=cycle_curves(kinematics, found, recording.rate),
        spatiotemporal=trial_spatiotemporal(recording, kinematics, found),
        subject=subject,
        motion=motion,
        kinetics=kinetics,
        weights=weights,
        arrays=arrays | (dict(weights.arrays) if weights is not None else {}),
        warnings=_trial_warnings(walk)
        + stride_warnings
        + motion_warnings(motion)
        + kinetics.warnings
        + (weights.warnings if weights is not None else ())
        + ((reason,) if reason else ()),
        not_converged=reason,
    )


def _try_weights(request: WeightsRequest, progress: Progress) -> tuple[TrialWeights | None, str]:
    """The weights as far as they came, and why they did not converge, if so."""
    try:
        weights = identify_weights(request, progress)
    except (NotConverged, WorkerLost) as error:
        return None, str(error)
    solver = weights.entry.solver
    reason = "" if solver.status == "solved" else solver.message or "the weights did not converge"
    return weights, reason


def _request(
    subject: SubjectModel, walk: _Walk, events: tuple[Event, ...], motion: InverseKinematics, options: AnalysisOptions
) -> WeightsRequest:
    return WeightsRequest(
        recording=walk.recording,
        events=events,
        subject=subject,
        q=motion.q,
        frames=cache(partial(single_frames, subject, walk.recording, walk.kinematics.heading, motion)),
        heading=walk.kinematics.heading,
        criteria=options.criteria,
        seed=options.seed,
        landing=options.landing,
        processes=options.processes,
    )


def _trial_warnings(walk: _Walk) -> tuple[str, ...]:
    recording = walk.recording
    gaps = describe_gaps(walk.gaps, recording.rate, frozenset(SEGMENT_OF_MARKER))
    return (*recording.warnings, *walk.calibration.warnings, *gaps)


def _build_subject(static: Recording | None, walk: _Walk, options: AnalysisOptions) -> SubjectModel:
    settings = SubjectSettings(anthropometry=options.anthropometry, trunk_joint=options.trunk_joint)
    if static is None:
        return person_model(walk.recording, walk.kinematics, walk.calibration.parameters, settings)
    standing = joint_kinematics(static, walk.calibration)
    return person_model(static, standing, walk.calibration.parameters, settings)


def _session(static: Recording | None, walk: _Walk, options: AnalysisOptions) -> Session:
    return Session(
        static=static,
        parameters=walk.calibration.parameters,
        assumed=assumed_parameters(walk.calibration, static, walk.recording, options.parameters),
        settings=_settings(options),
        warnings=static.warnings if static is not None else (),
        references=load_references(options.references),
    )


def _settings(options: AnalysisOptions) -> dict[str, Any]:
    """Every choice by name, as JSON can hold it."""
    plain = {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(options).items()}
    return plain | {"references": options.references.without_paths()}


def _entry(trial: TrialAnalysis) -> WeightsEntry | None:
    return None if trial.weights is None else trial.weights.entry
