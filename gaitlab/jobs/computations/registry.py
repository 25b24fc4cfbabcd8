"""Which module computes which kind of job."""

import importlib
from collections.abc import Mapping

from ...errors import NotFound
from ...pipelines.progress import Progress
from ..request import Work
from .outcome import Computation, Outcome

MODULES: Mapping[str, str] = {
    "inspect": "inspection",
    "analyse": "analysis",
    "predict": "prediction",
    "report": "report",
    "compare": "comparison",
    "norms": "norms",
}
"""Kind to a module of this package, each with a function `run`."""


def compute(work: Work, progress: Progress) -> Outcome:
    """Run the computation of the work's kind.

    Raises:
        GaitlabError: As the command line would say.
    """
    if work.kind not in MODULES:
        raise NotFound("kind of job", work.kind, MODULES)
    run: Computation = importlib.import_module(f"{__package__}.{MODULES[work.kind]}").run
    return run(work, progress)
