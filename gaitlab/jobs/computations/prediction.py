"""The new gait of a changed body or task, from an identified one."""

import msgspec

from ...pipelines.output import write_trial
from ...pipelines.predict import predict_walk
from ...pipelines.prediction_source import read_source
from ...pipelines.progress import Progress
from ...report.files import write_preview
from ..request import Work
from .outcome import Outcome, settings_of

RESULT = "result"
"""Folder of the analysis's files among the inputs."""


class PredictionOrder(msgspec.Struct, frozen=True, kw_only=True):
    """Settings of the job."""

    trial: str = ""
    """Name of a walk; empty: the first."""
    changes: tuple[str, ...] = ()
    """As `gaitlab predict --set`: name=value."""


def run(work: Work, progress: Progress) -> Outcome:
    """Predict from the files of the role `result`."""
    order = settings_of(work, PredictionOrder)
    found = predict_walk(read_source(work.folder / "inputs" / RESULT, order.trial), order.changes, progress)
    write_trial(found.trial, found.document, work.out)
    write_preview(work.out)
    reason = found.prediction.reason
    return Outcome(converged=not reason, message=reason, summary={"changes": list(order.changes)})
