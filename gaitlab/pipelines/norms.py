"""Reference cohorts from folders of results."""

from dataclasses import replace
from pathlib import Path

from ..clinical.cohort_building import CohortSettings, build_cohort
from ..clinical.document import Document, read_document
from ..clinical.normative import ReferenceCohort
from ..errors import InvalidRecording, InvalidReference


def cohort_of_folder(folder: Path, settings: CohortSettings) -> tuple[ReferenceCohort, tuple[str, ...]]:
    """Cohort of the results in the folders of a folder, one per person, and sentences on what was left out.

    Ages come from the settings of the results where `settings` has none, and only when every result has one.

    Raises:
        InvalidReference: There are no results, or too few.
    """
    documents: list[Document] = []
    problems: list[str] = []
    for path in sorted(folder.glob("*/result.json")):
        try:
            documents.append(read_document(path))
        except InvalidRecording as error:
            problems.append(f"{path.parent.name} left out: {error}")
    if not documents:
        raise InvalidReference(f"{folder} holds no folder with a readable result.json: run 'gaitlab analyse' first")
    ages = [_age(document) for document in documents]
    known = [age for age in ages if age is not None]
    if settings.age_years is None and len(known) == len(ages):
        settings = replace(settings, age_years=(min(known), max(known)))
    cohort, notes = build_cohort(documents, settings)
    return cohort, (*problems, *notes)


def _age(document: Document) -> float | None:
    references = document.settings.get("references")
    age = references.get("age") if isinstance(references, dict) else None
    return float(age) if isinstance(age, int | float) else None
