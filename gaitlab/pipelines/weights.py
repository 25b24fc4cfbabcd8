"""From measured coordinates to the weights of the criteria: the seam between gait analysis and optimal control."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from threading import Lock
from time import perf_counter

import msgspec
import numpy as np

from ..bilevel.result import rms
from ..clinical.document import StrideWeights, WeightsEntry
from ..errors import InvalidRecording, NotConverged
from ..mocap.cycle import Cycle
from ..mocap.cycles import full_strides
from ..mocap.recording import Event, Recording
from ..multibody.dynamics import layout_of
from ..multibody.subject import SubjectModel
from ..nlp.workers import Workers, results_of, worker_pool
from ..walking.contact_phases import GaitEvents, contact_phases, foot_directions
from ..walking.contact_schedule import Landing, ScheduleSettings, contact_stages
from ..walking.criteria import by_name
from ..walking.explanation import Explanation, ExplanationSettings, explain
from ..walking.identification import IdentificationSettings
from ..walking.identified_gait import IdentifiedGait, identified_gait
from ..walking.joint_search import MeasuredFrames
from ..walking.model import walking_functions
from ..walking.tracking import MeasuredStride, measured_stride
from .optimal_arrays import optimal_arrays
from .pooling import pool_strides
from .progress import Progress, Step
from .weights_entry import stride_entry, weights_entry

MOST_STRIDES = 2
"""Strides of one walk that are explained: each costs seconds, and overlapping strides say the same twice."""


@dataclass(frozen=True, kw_only=True)
class WeightsRequest:
    """One walk, ready for inverse optimal control."""

    recording: Recording
    """Short gaps filled; markers and plates in the laboratory frame."""
    events: tuple[Event, ...]
    subject: SubjectModel
    q: np.ndarray
    """Measured coordinates, gait frame [m, rad], shape (n_frames, n_q); NaN where markers are missing."""
    frames: Callable[[], MeasuredFrames]
    """Tells what the markers of single frames say, where the search needs to know."""
    heading: float
    """Direction of the gait frame's x axis in the laboratory [rad]."""
    criteria: tuple[str, ...]
    seed: int
    landing: Landing = "soft"
    processes: int = 0
    """Processes to compute with; 0: as many as there are processors."""


@dataclass(frozen=True, kw_only=True)
class TrialWeights:
    """What inverse optimal control found in one walk."""

    entry: WeightsEntry
    arrays: Mapping[str, np.ndarray]
    """q_optimal, tau_optimal, forces_optimal ... for walk.npz, shape (n_frames, ...), NaN outside the strides."""
    warnings: tuple[str, ...] = ()
    gait: IdentifiedGait | None = None
    """What predictions start from; None where no certified optimum was found."""


@dataclass(frozen=True, kw_only=True)
class ExplainedStride:
    """One stride with its explanation and the time that it took."""

    cycle: Cycle
    found: Explanation
    seconds: float


def identify_weights(request: WeightsRequest, progress: Progress) -> TrialWeights:
    """Tracking, the optimal walk and the weights of one walk: the most central stride, and one more where there is one.

    Raises:
        InvalidRecording: no stride of the walk can be used.
        NotConverged: no stride was solved.
        NotFound: a criterion does not exist.
    """
    for name in request.criteria:
        by_name(name)
    strides, skipped = usable_strides(request)
    progress(Step(stage="preparing the model (the first time on a machine: a minute)", trial=request.recording.name))
    walking_functions(layout_of(strides[0][1].subject))
    with worker_pool(request.processes) as workers:
        explained, failed = _explain_all(request, strides, progress, workers)
        unseen = _unseen(explained)
    main = explained[0]
    entries = [stride_entry(request.recording.name, s.cycle, s.found, s.seconds) for s in explained]
    entry = replace_strides(weights_entry(main.found, main.seconds), entries, unseen)
    recording = request.recording
    arrays = optimal_arrays(main.found, recording.n_frames, recording.rate, request.heading)
    found = main.found
    gait = identified_gait(found.optimum, found.estimate.theta, request.heading) if found.is_certified else None
    return TrialWeights(entry=entry, arrays=arrays, warnings=(*skipped, *failed), gait=gait)


def replace_strides(entry: WeightsEntry, strides: list[StrideWeights], unseen: dict[str, float]) -> WeightsEntry:
    """The entry with all strides, their pooled weights, and the fit on strides that were not used."""
    fit = msgspec.structs.replace(entry.fit, unseen_stride_rms_rad=unseen)
    return msgspec.structs.replace(entry, fit=fit, strides=strides, pooled=pool_strides(strides))


def usable_strides(request: WeightsRequest) -> tuple[list[tuple[Cycle, MeasuredStride]], tuple[str, ...]]:
    """Strides with known coordinates and a contact schedule, most central first, and why others were left out."""
    recording = request.recording
    feet = GaitEvents(feet=request.events, soles=recording.sole_changes)
    phases = contact_phases(request.subject, request.q, recording.rate, feet)
    directions = foot_directions(request.subject, request.q, phases)
    settings = ScheduleSettings(landing=request.landing)
    middle = 0.5 * (recording.n_frames - 1) / recording.rate
    candidates = sorted(
        full_strides(recording.name, request.events), key=lambda c: abs(0.5 * (c.start + c.end) - middle)
    )
    usable: list[tuple[Cycle, MeasuredStride]] = []
    skipped: list[str] = []
    for cycle in candidates:
        try:
            stages = contact_stages(phases, recording.rate, (cycle.start, cycle.end), settings, directions)
            start = round(cycle.start * recording.rate) / recording.rate
            usable.append((cycle, measured_stride(request.subject, stages, start, request.q, recording.rate)))
        except InvalidRecording as error:
            skipped.append(f"{cycle.side} stride at {cycle.start:.2f} s not used for the weights: {error}")
    if not usable:
        raise InvalidRecording(f"{recording.name}: no stride can be used for the weights. " + " ".join(skipped))
    return _apart(usable), tuple(skipped)


def frames_of(request: WeightsRequest, stride: MeasuredStride) -> MeasuredFrames:
    """What the markers of a stride's single frames say."""
    return request.frames().of_stride(stride)


def _apart(strides: list[tuple[Cycle, MeasuredStride]]) -> list[tuple[Cycle, MeasuredStride]]:
    """The first stride, then the others, those that overlap it least first."""
    first = strides[0][0]

    def overlap(item: tuple[Cycle, MeasuredStride]) -> float:
        return max(0.0, min(first.end, item[0].end) - max(first.start, item[0].start))

    return [strides[0], *sorted(strides[1:], key=overlap)]


@dataclass(frozen=True, kw_only=True)
class _StrideTask:
    """One stride to explain."""

    request: WeightsRequest
    cycle: Cycle
    stride: MeasuredStride
    with_others: bool
    """Whether to compare with other weights: the walk's first explained stride does, the others are for the spread."""

    @property
    def where(self) -> str:
        """The stride in words."""
        return f"{self.cycle.side} stride at {self.cycle.start:.2f} s"

    def run(self, progress: Progress, workers: Workers | None) -> ExplainedStride | str:
        """The explanation, or why there is none."""
        request, begin = self.request, perf_counter()

        def report(stage: str, iteration: int, residual: float) -> None:
            words = f"{stage}, {self.where}"
            known = residual if np.isfinite(residual) else None
            progress(Step(stage=words, trial=request.recording.name, iteration=iteration, residual=known))

        settings = ExplanationSettings(
            identification=IdentificationSettings(criteria=request.criteria), single_criteria=self.with_others
        )
        try:
            found = explain(self.stride, settings, report, workers, partial(frames_of, request, self.stride))
        except NotConverged as error:
            return f"{self.where}: {error}"
        return ExplainedStride(cycle=self.cycle, found=found, seconds=perf_counter() - begin)


def _explain_all(
    request: WeightsRequest,
    strides: Sequence[tuple[Cycle, MeasuredStride]],
    progress: Progress,
    workers: Workers | None,
) -> tuple[list[ExplainedStride], tuple[str, ...]]:
    """The first strides side by side where there are workers, further ones where those are not explained."""
    lock = Lock()

    def in_turn(step: Step) -> None:
        with lock:
            progress(step)

    explained, failed, waiting = list[ExplainedStride](), list[str](), list(strides)
    while waiting and len(explained) < MOST_STRIDES:
        wanted = MOST_STRIDES - len(explained)
        if workers is None or not explained and failed:
            wanted = 1
        tasks = [
            _StrideTask(request=request, cycle=cycle, stride=stride, with_others=not explained and i == 0)
            for i, (cycle, stride) in enumerate(waiting[:wanted])
        ]
        outcomes = results_of([partial(task.run, in_turn, workers) for task in tasks], workers)
        if not explained and isinstance(outcomes[0], str):
            # The next one is the first now.
            outcomes = outcomes[:1]
        waiting = waiting[len(outcomes) :]
        explained += [outcome for outcome in outcomes if isinstance(outcome, ExplainedStride)]
        failed += [outcome for outcome in outcomes if isinstance(outcome, str)]
    if not explained:
        raise NotConverged(f"{request.recording.name}: no stride could be explained. " + " ".join(failed))
    return explained, tuple(failed)


def _unseen(explained: Sequence[ExplainedStride]) -> dict[str, float]:
    """Fit of the first stride's weights on the other strides."""
    theta = explained[0].found.estimate.theta
    fits: dict[str, float] = {}
    for other in explained[1:]:
        found = other.found
        response = found.level.respond(theta, found.optimum.predict(theta - found.estimate.theta))
        fits[f"{other.cycle.side} {other.cycle.start:.2f} s"] = rms(response.residual)
    return fits
