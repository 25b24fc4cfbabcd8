"""The report: one self-contained HTML page from an output directory, same input same bytes, nothing to load."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from ..errors import OutputError
from .clinical_sections import (
    body_section,
    consistency_section,
    events_section,
    kinematics_section,
    spatiotemporal_section,
    subject_section,
)
from .kinetics_sections import emg_section, kinetics_section
from .markup import paragraph, tag
from .quality_sections import provenance_section, quality_section, warnings_box
from .result import Result, read_result, trial_directories
from .score_sections import scores_section, strides_section
from .walk_file import Angles, Walk, read_angles, read_walk
from .weights_sections import walk_section, weights_section

INTENDED_USE = (
    "Intended use: research tool, not a stand-alone diagnosis. The numbers describe recordings and a model; decisions "
    "about a person need a qualified clinician and further examination."
)
MOST_TRIALS = 4
"""Trials shown in full, so that the page stays below 1.5 MB; the rest have their own reports."""
# No script, no image, no request: what a hostile file name could smuggle in would not run.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"


def write_report(directory: Path) -> Path:
    """Write `report.html` of an output directory and return its path.

    Needs result.json; angles.csv and walk.npz add to it, and what is missing is said on the page with the reason. With
    several walks, the overall document comes first and each trial of `directory/<file stem>/` after it.

    Raises:
        OutputError: result.json is absent or broken, or the page cannot be written.
    """
    path = directory / "report.html"
    page = render(directory)
    try:
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error
    return path


def render(directory: Path) -> str:
    """The page as text."""
    overall = read_result(directory)
    trials = [path for path in trial_directories(directory) if path != directory]
    read = [(path, read_result(path)) for path in trials]
    shown = read[:MOST_TRIALS]
    parts = [
        _header(overall, [result for _, result in read]),
        _contents([result for _, result in shown]),
        warnings_box([("", overall), *((result.name, result) for _, result in read)]),
        subject_section(overall),
        _overall(overall, read) if trials else _single(overall, directory),
        *(_trial(number, path, result) for number, (path, result) in enumerate(shown, 1)),
        _omitted(trials[MOST_TRIALS:]),
        body_section(overall),
        provenance_section(overall),
    ]
    return _page(f"Gait report: {overall.name}", "".join(parts))


def _page(title: str, markup: str) -> str:
    style = (Path(__file__).parent / "report.css").read_text(encoding="utf-8")
    head = (
        '<meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{escape(_POLICY)}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{style}</style>"
    )
    footer = tag("footer", escape(INTENDED_USE))
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head><body>{tag("main", markup)}{footer}</body></html>\n'


def _header(overall: Result, trials: Sequence[Result]) -> str:
    unsolved = [r for r in (overall, *trials) if r.weights is not None and not r.weights.converged]
    state = "".join(
        paragraph(f"NOT CONVERGED: the weights of {r.name} carry no certificate and are marked below.", "stamp")
        for r in unsolved
    )
    version = escape(f"gaitlab {overall.document.get('version') or ''}".strip())
    brand = tag("p", version, "brand")
    return tag(
        "header", brand + tag("h1", f"Gait report: {escape(overall.name)}") + paragraph(INTENDED_USE, "use") + state
    )


def _contents(trials: Sequence[Result]) -> str:
    if not trials:
        return ""
    links = [f'<a href="#trial-{number}">{escape(result.name)}</a>' for number, result in enumerate(trials, 1)]
    return tag("nav", "Trials: " + " · ".join(links))


def _overall(result: Result, trials: Sequence[tuple[Path, Result]]) -> str:
    """What the trials have in common: pooled curves, all cycles, pooled weights."""
    read = [(trial, *_angles(path)) for path, trial in trials]
    parts = [
        kinematics_section(result),
        consistency_section(
            result, [(trial, angles) for trial, angles, _ in read], " ".join(why for *_, why in read).strip()
        ),
        kinetics_section(result),
        emg_section(result),
        strides_section(result),
        spatiotemporal_section(result),
        scores_section(result),
        weights_section(result),
    ]
    return "".join(parts)


def _single(result: Result, directory: Path) -> str:
    """Everything about one trial."""
    angles, why = _angles(directory)
    parts = [
        kinematics_section(result),
        consistency_section(result, [(result, angles)], why),
        kinetics_section(result),
        emg_section(result),
        strides_section(result),
        spatiotemporal_section(result),
        scores_section(result),
        weights_section(result),
        walk_section(result, *_walk(directory)),
        quality_section(result),
        events_section(result),
    ]
    return "".join(parts)


def _trial(number: int, directory: Path, result: Result) -> str:
    title = tag("h1", f"Trial: {escape(result.name)}")
    return tag("article", title + _single(result, directory), identifier=f"trial-{number}")


def _omitted(directories: Sequence[Path]) -> str:
    if not directories:
        return ""
    names = ", ".join(path.name for path in directories)
    return paragraph(
        f"Not shown: {names}. Reason: only the first {MOST_TRIALS} trials are shown in full, to keep this page "
        "small; the directories of the others hold their own reports.",
        "missing",
    )


def _walk(directory: Path) -> tuple[Walk | None, str]:
    try:
        return read_walk(directory), ""
    except OutputError as error:
        return None, _without_path(error, directory)


def _without_path(error: OutputError, directory: Path) -> str:
    # A path may hold a name that must not travel with the page.
    return str(error).replace(f"{directory / 'x'}"[:-1], "").replace(str(directory), "the directory")


def _angles(directory: Path) -> tuple[Angles | None, str]:
    try:
        return read_angles(directory), ""
    except OutputError as error:
        return None, _without_path(error, directory)
