"""The main job: angles, events, model, walk and weights of a visit, with the page that shows them."""

from dataclasses import replace
from pathlib import PurePath

from ...pipelines.analyse import Sources, analyse_files
from ...pipelines.options import AnalysisOptions
from ...pipelines.output import write_analysis
from ...pipelines.progress import Progress, Step
from ...pipelines.references import NONE
from ...report.files import write_preview
from ..request import Work
from .outcome import Outcome, settings_of


def run(work: Work, progress: Progress) -> Outcome:
    """Analyse the files of the roles `static` and `walk`, with own `norms` and `basis` where there are such files."""
    static = work.paths("static")
    sources = Sources(static=static[0] if static else None, walks=tuple(work.paths("walk")))
    analysis = analyse_files(sources, _options(work), progress)
    progress(Step(stage="report"))
    for folder in write_analysis(analysis, work.out):
        write_preview(folder)
    weights = analysis.document.weights
    summary = {
        "trials": [trial.recording.name for trial in analysis.trials],
        "warnings": len(analysis.document.warnings),
        "weights": None if weights is None else {each.name: each.weight for each in weights.criteria},
    }
    return Outcome(converged=not analysis.not_converged, message=analysis.not_converged, summary=summary)


def _options(work: Work) -> AnalysisOptions:
    options = settings_of(work, AnalysisOptions)
    references = options.references
    cohorts, bases = work.paths("norms"), work.paths("basis")
    if cohorts:
        references = replace(references, norms=str(cohorts[0]))
    elif references.norms != NONE:
        # Bundled norms only: any other path would reach into the files of this machine.
        references = replace(references, norms=PurePath(references.norms).stem)
    return replace(options, references=replace(references, gdi=str(bases[0]) if bases else ""))
