"""From analysed trials to the document of result.json."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import __version__
from ..clinical.cycle_average import average, complete
from ..clinical.document import (
    CURVES,
    SIDES,
    Curve,
    CurveSides,
    Document,
    EventEntry,
    GapEntry,
    InputFile,
    QualityEntry,
    SegmentEntry,
    SideSpatiotemporal,
    SpatiotemporalEntry,
    SubjectEntry,
    WeightsEntry,
)
from ..clinical.environment import environment
from ..clinical.spatiotemporal import mean, normalise, standard_deviation
from ..mocap.recording import Recording, Side
from ..multibody.subject import SubjectModel
from .kinetics import emg_entry, kinetics_entry
from .references import References
from .scores import scores_entry, strides_entry
from .trial import TrialAnalysis

PACKAGES = ("numpy", "scipy", "casadi", "pin", "ezc3d")
"""Besides gaitlab, what computes a result."""


@dataclass(frozen=True, kw_only=True)
class Session:
    """What all trials of one analysis share."""

    static: Recording | None
    parameters: Mapping[str, float]
    """Body parameters as used, SI units."""
    assumed: tuple[str, ...]
    settings: Mapping[str, Any]
    warnings: tuple[str, ...]
    references: References


def document_of(session: Session, trials: Sequence[TrialAnalysis], weights: WeightsEntry | None) -> Document:
    """The document of one trial, or of several together."""
    sides = SpatiotemporalEntry(
        left=_spatiotemporal(session, trials, "left"), right=_spatiotemporal(session, trials, "right")
    )
    return Document(
        version=__version__,
        inputs=_inputs(session, trials),
        subject=_subject(session, trials[0].subject),
        events=[
            EventEntry(side=e.side, kind=e.kind, time_s=e.time, source=e.source, trial=trial.name)
            for trial in trials
            for e in trial.events
        ],
        spatiotemporal=sides,
        kinematics={
            curve: CurveSides(left=_curve(trials, curve, "left"), right=_curve(trials, curve, "right"))
            for curve in CURVES
        },
        kinetics=kinetics_entry([trial.kinetics for trial in trials]),
        emg=emg_entry([trial.kinetics for trial in trials]),
        weights=weights,
        quality=_quality(session, trials),
        settings=dict(session.settings),
        warnings=_warnings(session, trials),
        strides=strides_entry(trials),
        scores=scores_entry(trials, session.references, _leg_length(session), _speed(sides)),
        environment=environment(PACKAGES),
    )


def _leg_length(session: Session) -> float | None:
    """Mean of both legs, or the one that is known [m]."""
    known = [value for side in SIDES if (value := session.parameters.get(f"{side}_leg_length")) is not None]
    return float(np.mean(known)) if known else None


def _speed(sides: SpatiotemporalEntry) -> float | None:
    """Mean of both sides, or the one that is known [m/s]."""
    known = [s.mean.speed_m_per_s for s in (sides.left, sides.right) if s is not None]
    speeds = [speed for speed in known if speed is not None]
    return float(np.mean(speeds)) if speeds else None


def _warnings(session: Session, trials: Sequence[TrialAnalysis]) -> list[str]:
    own = [_named(trial.name, warning) for trial in trials for warning in trial.warnings]
    return list(dict.fromkeys([*session.warnings, *own]))


def _named(trial: str, warning: str) -> str:
    return warning if warning.startswith(trial) else f"{trial}: {warning}"


def _inputs(session: Session, trials: Sequence[TrialAnalysis]) -> list[InputFile]:
    walks = [_input(trial.recording, "walk") for trial in trials]
    return walks if session.static is None else [_input(session.static, "static"), *walks]


def _input(recording: Recording, role: Any) -> InputFile:
    return InputFile(
        name=f"{recording.name}.c3d",
        role=role,
        sha256=recording.sha256,
        rate_hz=recording.rate,
        n_frames=recording.n_frames,
    )


def _subject(session: Session, subject: SubjectModel) -> SubjectEntry:
    return SubjectEntry(
        mass_kg=session.parameters.get("mass"),
        height_m=session.parameters.get("height"),
        parameters=dict(sorted(session.parameters.items())),
        assumed=list(session.assumed),
        preset=f"{subject.n_q} coordinates",
        segments=[
            SegmentEntry(name=segment.name, mass_kg=segment.mass, length_m=_length(subject, index))
            for index, segment in enumerate(subject.segments)
        ],
    )


def _length(subject: SubjectModel, index: int) -> float | None:
    """Distance to the next joint, [m]; None for the root and for segments that carry none."""
    children = [segment for segment in subject.segments if segment.parent == index]
    return float(np.linalg.norm(children[0].joint_offset)) if len(children) == 1 else None


def _spatiotemporal(session: Session, trials: Sequence[TrialAnalysis], side: Side) -> SideSpatiotemporal | None:
    cycles = [cycle for trial in trials for cycle in trial.spatiotemporal[side]]
    if not cycles:
        return None
    means = mean(cycles)
    leg = session.parameters.get(f"{side}_leg_length")
    return SideSpatiotemporal(
        n_cycles=len(cycles),
        mean=means,
        sd=standard_deviation(cycles),
        normalised=normalise(means, leg),
        cycles=cycles,
        normalised_cycles=[normalise(cycle, leg) for cycle in cycles],
    )


def _curve(trials: Sequence[TrialAnalysis], curve: str, side: Side) -> Curve | None:
    cycles = [cycle for trial in trials for cycle in trial.curves[curve][side]]
    whole = complete(cycles)
    if not whole:
        return None
    mean_curve, deviation = average(whole)
    return Curve(mean=_numbers(mean_curve), sd=_numbers(deviation), n_cycles=len(whole))


def _numbers(values: np.ndarray) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def _quality(session: Session, trials: Sequence[TrialAnalysis]) -> QualityEntry:
    residuals = {name: value for trial in trials for name, value in trial.motion.rms_by_marker().items()}
    squares = [trial.motion.marker_rms**2 for trial in trials]
    return QualityEntry(
        gaps=[gap for trial in trials for gap in _gaps(trial)],
        calibration=trials[0].calibration,
        marker_residual_rms_m=float(np.sqrt(np.mean(squares))),
        marker_residuals_m=dict(residuals),
    )


def _gaps(trial: TrialAnalysis) -> list[GapEntry]:
    rate = trial.recording.rate
    return [
        GapEntry(trial=trial.name, marker=gap.marker, start_s=gap.start / rate, end_s=gap.end / rate, filled=gap.filled)
        for gap in trial.gaps
    ]
