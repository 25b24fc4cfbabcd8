"""A reference cohort from results of able-bodied people."""

from ...clinical.cohort_building import CohortSettings
from ...clinical.normative import write_cohort
from ...pipelines.norms import cohort_of_folder
from ...pipelines.progress import Progress, Step
from ..request import Work
from .outcome import Outcome, settings_of


def run(work: Work, progress: Progress) -> Outcome:
    """Build the cohort of the results, each of which lies in a folder of its own."""
    progress(Step(stage="norms"))
    cohort, notes = cohort_of_folder(work.folder / "inputs", settings_of(work, CohortSettings))
    write_cohort(cohort, work.out / "norms.json")
    return Outcome(summary={"name": cohort.name, "notes": list(notes)})
