"""`gaitlab compare`: result folders side by side."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from ..clinical.comparison import MINIMAL, Comparison, compare, tables
from ..errors import OutputError
from ..pipelines.compare import read_members, read_minimal, write_tables
from ..pipelines.output import make_folder
from ..report.colours import Palette, recoloured
from ..report.comparison_figures import figures

MOST_ROWS = 8
"""Results printed; the tables hold all of them."""


def compare_results(
    folders: Annotated[list[str], typer.Argument(help="Result folders, each DIR or GROUP=DIR.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Folder to write tables and figures into; made if absent.")],
    baseline: Annotated[str, typer.Option(help="Result that differences are taken from; default the first.")] = "",
    minimal: Annotated[
        Path | None, typer.Option(help="More minimal differences: CSV with quantity, value, source.")
    ] = None,
    parquet: Annotated[bool, typer.Option(help="Write every table as Parquet, too (needs pyarrow).")] = False,
    colours: Annotated[
        Palette, typer.Option(help="green: right side green; safe: for colour-blind eyes and grey paper.")
    ] = "standard",
) -> None:
    """Compare results before and after, of several people, or of groups: tables and figures."""
    make_folder(out)
    members, problems = read_members(folders)
    comparison = compare(members, baseline, MINIMAL if minimal is None else read_minimal(minimal))
    written = [*write_tables(comparison, out, parquet)]
    for name, markup in figures(comparison).items():
        path = out / f"{name}.svg"
        try:
            path.write_text(recoloured(markup, colours), encoding="utf-8")
        except OSError as error:
            raise OutputError(f"{path} cannot be written ({error.strerror})") from error
        written.append(path)
    console = Console()
    console.print(_summary(comparison))
    for problem in problems:
        console.print(f"warning: {problem}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    console.print(f"written: {', '.join(path.name for path in written)}", markup=False, highlight=False)


def _summary(comparison: Comparison) -> Table:
    """Overall scores and speeds with their differences to the baseline."""
    table = Table("result", "quantity", "value", "difference", "MCID", title=f"Compared with {comparison.baseline}")
    shown = [row for row in tables(comparison)["quantities"].rows if row[2] in ("gps_overall", "speed_m_per_s")]
    for label, _, name, side, value, _, difference, least, *_ in shown[: 3 * MOST_ROWS]:
        cells = [f"{name} {side}".strip(), *("-" if v is None else f"{v:.2f}" for v in (value, difference, least))]
        table.add_row(str(label), *cells)
    return table
