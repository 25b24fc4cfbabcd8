"""`gaitlab export`: results in the formats of other programs."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from ..report.exports import FORMATS, Export, export


def export_results(
    folder: Annotated[Path, typer.Argument(help="Result folder, from 'gaitlab analyse'.", show_default=False)],
    to: Annotated[list[str], typer.Option("--to", help=f"Format: {', '.join(FORMATS)}. May be given several times.")],
    out: Annotated[Path | None, typer.Option(help="Folder to write into; default FOLDER/export.")] = None,
    recording: Annotated[
        list[Path] | None, typer.Option(help="C3D file that the result was made from; for --to c3d, one each.")
    ] = None,
) -> None:
    """Write a result as C3D, OpenSim (.trc, .mot), FHIR, CSV or JSON."""
    target = out or folder / "export"
    console = Console()
    job = Export(directory=folder, out=target, recordings=tuple(recording or ()))
    written, problems = export(job, to)
    for problem in problems:
        console.print(f"warning: {problem}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    names = ", ".join(path.name for path in written)
    console.print(f"written to {target}: {names}", markup=False, highlight=False, soft_wrap=True)
