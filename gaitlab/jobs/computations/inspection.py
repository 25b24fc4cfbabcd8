"""What is in a recording."""

from ...errors import InvalidRecording
from ...pipelines.inspect import inspect_file
from ...pipelines.progress import Progress, Step
from ..request import Work
from .outcome import Outcome

PRIVATE = "gaitlab does not keep it"
"""How `mocap.privacy` ends a sentence on personal data in a file."""


def run(work: Work, progress: Progress) -> Outcome:
    """Describe the file of the role `recording`."""
    paths = work.paths("recording")
    if len(paths) != 1:
        raise InvalidRecording(f"the job inspect looks at one recording, got {len(paths)}")
    progress(Step(stage="reading", trial=paths[0].stem))
    rows = inspect_file(paths[0]).rows
    warnings = dict(rows)["warnings"].split("; ")
    personal = [warning for warning in warnings if warning.endswith(PRIVATE)]
    return Outcome(summary={"rows": [list(row) for row in rows], "personal_entries": personal})
