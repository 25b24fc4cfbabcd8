"""From a request for a computation to a job: the files it reads, its settings, whose data it is."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any, get_args
from uuid import UUID

from sqlalchemy import select

from ..errors import Conflict, InvalidRecording, InvalidRequest
from ..jobs.queue import submit
from ..jobs.request import OWNER, JobInput, JobRequest
from ..storage.models import (
    CohortMember,
    GaitSession,
    Job,
    JobKind,
    Patient,
    Recording,
    RecordingKind,
    Result,
    ResultFile,
    Subject,
)
from . import visibility
from .caller import Call
from .choices import NormName
from .problems import Absent
from .schemas.work import (
    AnalysisSettings,
    ComparedResult,
    NewAnalysis,
    NewComparison,
    NewInspection,
    NewJob,
    NewNorms,
    NewPrediction,
    NewReport,
)

DOCUMENT = "result.json"
NORMS = "norms.json"
NORM_NAMES: frozenset[str] = frozenset(get_args(NormName))


def order(call: Call, wanted: NewJob) -> tuple[Job, bool]:
    """Ask for the job; the flag tells whether it is new, or an equal one was there."""
    return submit(call.db, _ORDERS[type(wanted)](call, wanted))


def _request(
    call: Call, kind: JobKind, inputs: Sequence[JobInput], patients: frozenset[UUID], **more: Any
) -> JobRequest:
    return JobRequest(
        kind=kind,
        inputs=tuple(inputs),
        patients=patients,
        created_by=call.caller.user_id,
        request_id=call.origin.request_id,
        **more,
    )


def order_inspection(call: Call, recording: Recording, patient_id: UUID) -> Job:
    """The look into a recording that has just arrived."""
    request = _inspection(call, recording, patient_id, 0)
    return submit(call.db, request)[0]


def _inspection(call: Call, recording: Recording, patient_id: UUID, priority: int) -> JobRequest:
    file = _recording_input("recording", recording)
    return _request(
        call,
        JobKind.INSPECT,
        [file],
        frozenset({patient_id}),
        session_id=recording.session_id,
        priority=priority,
    )


def _recording_input(role: str, recording: Recording) -> JobInput:
    return JobInput(role=role, name=recording.name, sha256=recording.sha256, source=recording.id)


def _order_inspection(call: Call, wanted: NewInspection) -> JobRequest:
    recording = visibility.part(call, Recording, wanted.recording_id, "analyse")
    return _inspection(call, recording, visibility.patient_of(call, recording.session_id), wanted.priority)


def _order_analysis(call: Call, wanted: NewAnalysis) -> JobRequest:
    visit = visibility.gait_session(call, wanted.session_id, "analyse")
    query = select(Recording).where(Recording.session_id == visit.id).order_by(Recording.created_at, Recording.id)
    recordings = list(call.db.scalars(query))
    static, walks = _roles(recordings, wanted)
    _check_names([*static, *walks])
    inputs = [_recording_input("static", each) for each in static] + [_recording_input("walk", each) for each in walks]
    age = wanted.settings.age if wanted.settings.age is not None else visit.age_years
    settings, norms = _analysis_settings(call, wanted.settings, age)
    if wanted.subject_id is not None:
        subject = visibility.part(call, Subject, wanted.subject_id, "analyse")
        if visibility.patient_of(call, subject.session_id) != visit.patient_id:
            raise Absent("subject of this patient", wanted.subject_id)
        settings["parameters"] = {**subject.parameters, **settings["parameters"]}
        settings[OWNER] = str(subject.id)
    return _request(
        call,
        JobKind.ANALYSE,
        inputs + norms,
        frozenset({visit.patient_id}),
        session_id=visit.id,
        settings=settings,
        priority=wanted.priority,
    )


def _roles(recordings: Sequence[Recording], wanted: NewAnalysis) -> tuple[list[Recording], list[Recording]]:
    """The static trial, if any, and the walks."""
    known = {recording.id: recording for recording in recordings}
    for recording_id in (*wanted.walks, *([] if wanted.static is None else [wanted.static])):
        if recording_id not in known:
            raise Absent("recording of this session", recording_id)
    walks = [known[each] for each in dict.fromkeys(wanted.walks)]
    if not walks:
        walks = [recording for recording in recordings if recording.kind is RecordingKind.WALK]
    if not walks:
        raise InvalidRecording("the session has no walking trial: send one, or correct what its recordings show")
    if wanted.static is not None:
        return [known[wanted.static]], [walk for walk in walks if walk.id != wanted.static]
    statics = [recording for recording in recordings if recording.kind is RecordingKind.STATIC]
    return statics[-1:], walks


def _check_names(recordings: Sequence[Recording]) -> None:
    twice = [name for name, count in Counter(recording.name for recording in recordings).items() if count > 1]
    if twice:
        raise InvalidRecording(f"two recordings are called {twice[0]}; results are named after files, so rename one")


def _analysis_settings(
    call: Call, settings: AnalysisSettings, age: float | None
) -> tuple[dict[str, Any], list[JobInput]]:
    """Settings as `AnalysisOptions` reads them, and the norms of one's own as a file."""
    plain = settings.model_dump(exclude={"norms", "match_speed", "age"}, mode="json")
    references: dict[str, Any] = {"speed": "matched" if settings.match_speed else "default", "age": age}
    inputs: list[JobInput] = []
    if settings.norms in NORM_NAMES:
        references["norms"] = settings.norms
    else:
        inputs.append(_norms(call, settings.norms))
    return {**plain, "processes": 1, "references": references}, inputs


def _norms(call: Call, text: str) -> JobInput:
    try:
        result_id = UUID(text)
    except ValueError as error:
        names = ", ".join(sorted(NORM_NAMES))
        raise InvalidRequest(f"norms '{text}' do not exist; available: {names}, or the id of a result") from error
    result = visibility.result(call, result_id, "read")
    return _result_input(call, "norms", result, NORMS, NORMS)


def _result_input(call: Call, role: str, result: Result, file: str, name: str, **extra: Any) -> JobInput:
    found = call.db.get(ResultFile, (result.id, file))
    if found is None:
        raise Absent(f"file {file} of result", result.id)
    return JobInput(role=role, name=name, sha256=found.sha256, source=result.id, extra=extra)


def _order_prediction(call: Call, wanted: NewPrediction) -> JobRequest:
    result = _analysed(call, wanted.result_id)
    inputs = _every_file(call, "result", result, "result/")
    settings = {"trial": wanted.trial, "changes": list(wanted.changes)}
    return _request(
        call,
        JobKind.PREDICT,
        inputs,
        frozenset(visibility.patients_of(call, result.job_id)),
        session_id=result.session_id,
        settings=settings,
        priority=wanted.priority,
    )


def _inputs_of(job: Job) -> list[JobInput]:
    return [
        JobInput(
            role=each["role"],
            name=each["name"],
            sha256=each["sha256"],
            source=UUID(each["source"]),
            extra=each.get("extra", {}),
        )
        for each in job.inputs
    ]


def _analysed(call: Call, result_id: UUID) -> Result:
    result = visibility.result(call, result_id, "analyse")
    if result.kind is not JobKind.ANALYSE:
        raise Conflict(f"the result is of the kind {result.kind}; one of the kind analyse is needed")
    return result


def _every_file(call: Call, role: str, result: Result, folder: str) -> list[JobInput]:
    query = select(ResultFile).where(ResultFile.result_id == result.id).order_by(ResultFile.name)
    return [
        JobInput(role=role, name=f"{folder}{file.name}", sha256=file.sha256, source=result.id)
        for file in call.db.scalars(query)
    ]


def _order_report(call: Call, wanted: NewReport) -> JobRequest:
    result = _analysed(call, wanted.result_id)
    inputs = _every_file(call, "result", result, "result/")
    patients = visibility.patients_of(call, result.job_id)
    content = wanted.content
    settings = {
        "pages": list(content.pages),
        "colours": content.colours,
        "examination": _examination(call, result, content.notes),
    }
    return _request(
        call,
        JobKind.REPORT,
        inputs,
        frozenset(patients),
        session_id=result.session_id,
        settings=settings,
        priority=wanted.priority,
    )


def _examination(call: Call, result: Result, notes: Sequence[str]) -> dict[str, Any]:
    """What the report says of patient and visit: the pseudonym, never the name."""
    if result.session_id is None:
        return {}
    visit = call.db.get_one(GaitSession, result.session_id)
    patient = call.db.get_one(Patient, visit.patient_id)
    known: dict[str, Any] = dict(visit.examination)
    person = {"pseudonym": patient.pseudonym, "diagnosis": patient.diagnosis}
    return {
        **known,
        "patient": {**person, **known.get("patient", {})},
        "session": {"date": visit.visited_on.isoformat(), **known.get("session", {})},
        "condition": {"note": visit.condition, **known.get("condition", {})},
        "notes": [*known.get("notes", []), *notes],
    }


def members(
    call: Call, wanted: Sequence[ComparedResult], action: str = "analyse"
) -> tuple[list[JobInput], frozenset[UUID]]:
    """Documents of results side by side, labelled by their identifiers, and whose they are."""
    inputs: list[JobInput] = []
    patients: set[UUID] = set()
    for each in wanted:
        result = visibility.result(call, each.result_id, action)
        label = str(result.id)
        extra = {"label": label, "group": each.group or label}
        inputs.append(_result_input(call, "result", result, DOCUMENT, f"{label}/{DOCUMENT}", **extra))
        patients |= set(visibility.patients_of(call, result.job_id))
    return inputs, frozenset(patients)


def _order_comparison(call: Call, wanted: NewComparison) -> JobRequest:
    inputs, patients = members(call, wanted.members)
    settings = {"baseline": str(wanted.baseline or ""), "parquet": True}
    return _request(call, JobKind.COMPARE, inputs, patients, settings=settings, priority=wanted.priority)


def _order_norms(call: Call, wanted: NewNorms) -> JobRequest:
    query = select(CohortMember.result_id, CohortMember.group).where(CohortMember.cohort_id == wanted.cohort_id)
    rows = call.db.execute(query.order_by(CohortMember.result_id)).all()
    if not rows:
        raise Absent("cohort with members", wanted.cohort_id)
    inputs, patients = members(call, [ComparedResult(result_id=each, group=group) for each, group in rows])
    settings = {
        "name": wanted.name,
        "source": wanted.source,
        "licence": wanted.licence,
        "age_years": wanted.ages,
        "speed_edges": list(wanted.speed_edges),
    }
    return _request(call, JobKind.NORMS, inputs, patients, settings=settings, priority=wanted.priority)


def again(call: Call, job: Job) -> Job:
    """The same job once more, after it failed or was cancelled."""
    inputs = _inputs_of(job)
    request = _request(
        call,
        job.kind,
        inputs,
        frozenset(visibility.patients_of(call, job.id)),
        session_id=job.session_id,
        settings=job.settings,
        priority=job.priority,
    )
    return submit(call.db, request)[0]


_ORDERS: Mapping[type, Callable[[Call, Any], JobRequest]] = {
    NewInspection: _order_inspection,
    NewAnalysis: _order_analysis,
    NewPrediction: _order_prediction,
    NewReport: _order_report,
    NewComparison: _order_comparison,
    NewNorms: _order_norms,
}
