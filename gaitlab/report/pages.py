"""The pages of a report, in order: what each shows is decided here, how it looks by the writers of HTML and PDF."""

from collections.abc import Callable, Mapping, Sequence

from ..errors import OutputError
from .blocks import Page, Section, missing, section
from .clinical_sections import (
    body_section,
    events_section,
    kinematics_section,
    spatiotemporal_section,
)
from .consistency_sections import angles_section, kinetics_cycles_section
from .examination_sections import beside_curves, examination_sections
from .front_sections import front_sections
from .kinetics_sections import emg_sections, kinetics_sections
from .prediction_sections import prediction_sections
from .provenance_sections import provenance_sections
from .quality_sections import quality_sections
from .result import mapping, sequence
from .score_sections import scores_sections, strides_section
from .source import Source, Trial
from .stills_section import stills_section
from .walk_sections import share_section, walk_sections
from .weights_sections import weights_sections

KEYS = (
    "front",
    "examination",
    "kinematics",
    "consistency",
    "kinetics",
    "emg",
    "spatiotemporal",
    "scores",
    "weights",
    "walk",
    "stills",
    "quality",
    "provenance",
)
"""Names of the pages, in their order."""
MOST_TRIALS = 4
"""Trials with pages of their own, so that the report stays small; the rest have their own reports."""


def report_pages(source: Source, program: Mapping[str, str], keys: Sequence[str] = KEYS) -> tuple[Page, ...]:
    """All pages that are asked for.

    Args:
        source: What the report is made from.
        program: Versions and machine that make the report, by name.
        keys: Names of pages; their order does not matter.

    Raises:
        OutputError: A page of that name does not exist.
    """
    unknown = [key for key in keys if key not in KEYS]
    if unknown or not keys:
        raise OutputError(f"pages '{', '.join(unknown)}' do not exist; available: {', '.join(KEYS)}")
    overall = source.overall
    makers: dict[str, Callable[[], tuple[Section, ...]]] = {
        "front": lambda: front_sections(source),
        "examination": lambda: examination_sections(source),
        "kinematics": lambda: (kinematics_section(overall, beside_curves(source.examination)),),
        "consistency": lambda: (angles_section(source), strides_section(overall), kinetics_cycles_section(source)),
        "kinetics": lambda: kinetics_sections(overall),
        "emg": lambda: emg_sections(overall),
        "spatiotemporal": lambda: (spatiotemporal_section(overall),),
        "scores": lambda: scores_sections(overall),
        "weights": lambda: weights_sections(overall),
        **_common_walk_pages(source),
        "quality": lambda: (*quality_sections(overall), events_section(overall), body_section(overall)),
        "provenance": lambda: provenance_sections(source, program),
    }
    common = [Page(key=key, sections=makers[key]()) for key in KEYS if key in keys and key in makers]
    return (*common, *_trial_pages(source, keys))


def _common_walk_pages(source: Source) -> dict[str, Callable[[], tuple[Section, ...]]]:
    """Of one trial everything on its walk; of several the stills of the representative one, if none is solved."""
    if not source.several:
        return _walk_pages(source.trials[0])
    if _solved(source):
        return {}
    trial = _representative(source)
    return {"stills": lambda: (stills_section(trial.result, trial.walk, trial.problems.get("walk", "")),)}


def _solved(source: Source) -> list[Trial]:
    return [t for t in source.trials if t.walk is not None and t.walk.numbers("q_optimal", 2) is not None]


def _representative(source: Source) -> Trial:
    """The trial of the stride closest to the median stride; the first where none is marked."""
    strides = [mapping(item) for item in sequence(source.overall.part("strides").get("strides"))]
    named = [stride.get("trial") for stride in strides if stride.get("representative") is True]
    return next((trial for name in named for trial in source.trials if trial.result.name == name), source.trials[0])


def _walk_pages(trial: Trial) -> dict[str, Callable[[], tuple[Section, ...]]]:
    """Makers of the pages on the weights and the walk in time of one trial."""
    result, why = trial.result, trial.problems.get("walk", "")
    return {
        "weights": lambda: _weights_page(trial),
        "walk": lambda: (*prediction_sections(result), *walk_sections(result, trial.walk, why)),
        "stills": lambda: (stills_section(result, trial.walk, why),),
    }


def _weights_page(trial: Trial) -> tuple[Section, ...]:
    words, *rest = weights_sections(trial.result)
    share = [share_section(trial.result, trial.walk, trial.problems.get("walk", ""))] if rest else []
    return (words, *share, *rest)


def _trial_pages(source: Source, keys: Sequence[str]) -> list[Page]:
    """Weights, walk and stills of each of several trials that have an optimal walk."""
    if not source.several:
        return []
    pages = list[Page]()
    solved = _solved(source)
    for trial in solved[:MOST_TRIALS]:
        found = _walk_pages(trial)
        pages += [Page(key=key, sections=found[key](), trial=trial.result.name) for key in found if key in keys]
    rest = ", ".join(trial.result.name for trial in solved[MOST_TRIALS:])
    if rest:
        why = (
            f"only the first {MOST_TRIALS} trials have pages of their own, to keep this report small; the directories "
            "of the others hold their own reports"
        )
        pages.append(Page(key="trials", sections=(section("Other trials", missing(rest, why)),)))
    return pages
