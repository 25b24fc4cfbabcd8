"""`gaitlab analyse`: C3D in, result folder out."""

from pathlib import Path
from typing import Annotated

import typer

from ..clinical.document import SIDES
from ..errors import InvalidSubject, NotConverged
from ..inverse.leg_kinetics import MomentFrame
from ..pipelines.analyse import Sources, analyse_files
from ..pipelines.options import AnalysisOptions
from ..pipelines.output import make_folder, write_analysis
from ..pipelines.references import BUNDLED, ReferenceOptions
from ..report.files import write_preview
from ..report.ledger import refuse_signed
from ..walking.criteria import THESIS
from .progress import progress_bars
from .summary import print_summary

FILE_OFFSETS = "Use the static offsets stored in the file, not those computed."
ALONG_WALK = "Forward is the walking direction itself, not the laboratory axis next to it."
VICON_INERTIA = "Segment inertia as in Plug-in Gait, to compare moments."


def analyse(  # noqa: PLR0913 - one argument per option of the command
    walks: Annotated[list[Path], typer.Argument(help="Walking trials, C3D.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Folder to write into; made if absent.")],
    static: Annotated[Path | None, typer.Option(help="Static trial of the same session, C3D.")] = None,
    mass: Annotated[float | None, typer.Option(help="Body mass [kg]; replaces the files'.")] = None,
    height: Annotated[float | None, typer.Option(help="Body height [m].")] = None,
    leg_length: Annotated[float | None, typer.Option(help="Leg length, both sides [m].")] = None,
    knee_width: Annotated[float | None, typer.Option(help="Knee width, both sides [m].")] = None,
    ankle_width: Annotated[float | None, typer.Option(help="Ankle width, both sides [m].")] = None,
    parameter: Annotated[
        list[str] | None, typer.Option(help="Any other, as name=value in SI units: left_leg_length=0.82.")
    ] = None,
    criteria: Annotated[str, typer.Option(help="Criteria, separated by commas.")] = ",".join(THESIS),
    weights: Annotated[bool, typer.Option(help="Compute the walk and its weights.")] = True,
    trunk_joint: Annotated[bool, typer.Option(help="Give the trunk a joint of its own on the pelvis.")] = False,
    impacts: Annotated[bool, typer.Option(help="Let feet land by an impact instead of softly.")] = False,
    seed: Annotated[int, typer.Option(help="Seed of everything random.", min=0)] = 0,
    processes: Annotated[int, typer.Option(help="Processes to compute with; 0: all processors.", min=0)] = 0,
    redetect_events: Annotated[bool, typer.Option(help="Detect events although the file has some.")] = False,
    file_offsets: Annotated[bool, typer.Option(help=FILE_OFFSETS)] = False,
    along_walk: Annotated[bool, typer.Option(help=ALONG_WALK)] = False,
    moments_in: Annotated[MomentFrame, typer.Option(help="Axes that joint moments are expressed in.")] = "distal",
    vicon_inertia: Annotated[bool, typer.Option(help=VICON_INERTIA)] = False,
    norms: Annotated[str, typer.Option(help="Reference cohort: a file of 'gaitlab norms build', or none.")] = BUNDLED,
    match_speed: Annotated[bool, typer.Option(help="Compare with norms of the person's own speed.")] = False,
    gdi: Annotated[Path | None, typer.Option(help="Basis of the gait deviation index, from norms import-gdi.")] = None,
    age: Annotated[float | None, typer.Option(help="Age of the person [years], checked against the norms.")] = None,
) -> None:
    """Turn a static and walking trials into angles, events, a model, a walk and the weights of its criteria."""
    both = {"leg_length": leg_length, "knee_width": knee_width, "ankle_width": ankle_width}
    options = AnalysisOptions(
        parameters=_parameters({"mass": mass, "height": height}, both, parameter or []),
        criteria=tuple(name.strip() for name in criteria.split(",") if name.strip()),
        weights=weights,
        seed=seed,
        landing="impact" if impacts else "soft",
        processes=processes,
        trunk_joint=trunk_joint,
        redetect_events=redetect_events,
        static_offsets="file" if file_offsets else "computed",
        forward="heading" if along_walk else "laboratory axis",
        moment_frame=moments_in,
        kinetics_inertia="plug-in gait" if vicon_inertia else "subject",
        references=ReferenceOptions(
            norms=norms, gdi=str(gdi or ""), speed="matched" if match_speed else "default", age=age
        ),
    )
    run_analysis(Sources(static=static, walks=tuple(walks)), options, out)


def run_analysis(sources: Sources, options: AnalysisOptions, out: Path) -> None:
    """Analyse, write, report and print; raises NotConverged after writing when something did not converge."""
    make_folder(out)
    refuse_signed(out)
    with progress_bars() as progress:
        analysis = analyse_files(sources, options, progress)
        folders = write_analysis(analysis, out)
        for folder in folders:
            write_preview(folder)
    print_summary(analysis.document, out)
    if analysis.not_converged:
        raise NotConverged(f"{analysis.not_converged}; the results so far are in {out}")


def _parameters(
    single: dict[str, float | None], both: dict[str, float | None], assignments: list[str]
) -> dict[str, float]:
    parameters = {name: value for name, value in single.items() if value is not None}
    for name, value in both.items():
        if value is not None:
            parameters |= {f"{side}_{name}": value for side in SIDES}
    return parameters | dict(_assignment(text) for text in assignments)


def _assignment(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name.strip(), float(value)
    except ValueError as error:
        raise InvalidSubject(f"--parameter {text} is not name=number, as left_leg_length=0.82") from error
