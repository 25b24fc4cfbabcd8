"""`gaitlab norms`: reference cohorts and the basis of the gait deviation index."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from ..clinical.cohort_building import CohortSettings
from ..clinical.deviation_workbook import import_basis
from ..clinical.gait_deviation_index import write_basis
from ..clinical.normative import describe, read_cohort, write_cohort
from ..errors import InvalidReference
from ..pipelines.norms import cohort_of_folder
from ..pipelines.references import BUNDLED, norm_path

norms = typer.Typer(name="norms", help="Reference cohorts, and the basis of the gait deviation index.")


@norms.command()
def build(  # noqa: PLR0913 - one argument per option of the command
    folder: Annotated[Path, typer.Argument(help="Holds one result folder per able-bodied person.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Norm file to write (JSON).")],
    name: Annotated[str, typer.Option(help="Name printed beside the band; default the folder's.")] = "",
    source: Annotated[str, typer.Option(help="Where the people come from.")] = "own laboratory",
    licence: Annotated[str, typer.Option(help="Who may use the file.")] = "own data of the laboratory",
    ages: Annotated[str, typer.Option(help="Youngest and oldest in years, as 6-12; default as in the results.")] = "",
    speed_edges: Annotated[str, typer.Option(help="Dimensionless speeds between bins, as 0.36,0.5.")] = "",
) -> None:
    """Build a reference cohort from a laboratory's own results."""
    settings = CohortSettings(
        name=name or folder.resolve().name,
        source=source,
        licence=licence,
        age_years=_ages(ages),
        speed_edges=tuple(_number(part, "--speed-edges") for part in speed_edges.split(",") if part.strip()),
    )
    cohort, notes = cohort_of_folder(folder, settings)
    write_cohort(cohort, out)
    console = Console()
    for note in notes:
        console.print(f"warning: {note}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    _print(out, console)


@norms.command(name="import-gdi")
def import_gdi(
    workbook: Annotated[Path, typer.Argument(help="Workbook (.xlsx) with the published basis.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Basis to write (JSON).")],
    source: Annotated[str, typer.Option(help="Publication that the workbook belongs to.")] = (
        "Schwartz & Rozumalski, Gait Posture 28:351, 2008"
    ),
) -> None:
    """Import the feature basis of the gait deviation index."""
    basis = import_basis(workbook, source)
    write_basis(basis, out)
    typer.echo(
        f"{out}: 15 features of 459 elements, ln distance of the controls "
        f"{basis.log_distance_mean:.4f} ± {basis.log_distance_sd:.4f}"
    )


@norms.command()
def show(
    norm_file: Annotated[str, typer.Argument(help="Norm file, or the name of bundled norms.")] = BUNDLED,
) -> None:
    """Print what a reference cohort holds."""
    _print(norm_path(norm_file), Console())


def _print(path: Path, console: Console) -> None:
    cohort = read_cohort(path)
    table = Table("bin", "persons", "speed [sqrt(g l)]", "curves", "default", title=cohort.name)
    for part in cohort.bins:
        speed = "-" if part.speed is None else f"{part.speed.mean:.3f} ± {part.speed.sd:.3f}"
        default = "yes" if part.name == cohort.default_bin else ""
        table.add_row(part.name, str(part.n), speed, str(len(part.curves)), default)
    console.print(table)
    for line in (describe(cohort, cohort.bin(cohort.default_bin)), cohort.source, cohort.licence, str(path)):
        console.print(line, markup=False, highlight=False, soft_wrap=True)


def _ages(text: str) -> tuple[float, float] | None:
    if not text:
        return None
    low, dash, high = text.partition("-")
    if not dash:
        raise InvalidReference(f"--ages {text} is not youngest-oldest, as 6-12")
    return _number(low, "--ages"), _number(high, "--ages")


def _number(text: str, option: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise InvalidReference(f"{option}: {text!r} is no number") from error
