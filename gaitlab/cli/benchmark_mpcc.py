"""`gaitlab benchmark mpcc`: every problem of a folder with every method."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from ..benchmarks.mpcc_collection import Limits, Row, problem_files, read_reference, run_collection, write_rows
from ..benchmarks.mpcc_methods import METHODS, method
from ..benchmarks.performance_profile import performance_profiles
from ..errors import OutputError
from ..report.performance_profile_figure import profile_figure


def mpcc(
    folder: Annotated[Path, typer.Argument(help="Folder with .nl, .json or .json.gz files.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Table to write (CSV); the performance profile goes beside it (SVG).")],
    methods: Annotated[
        list[str] | None, typer.Option("--method", help=f"Only this method, repeatable: {', '.join(METHODS)}.")
    ] = None,
    starts: Annotated[int, typer.Option(help="Starts per problem and method; the first is the file's.", min=1)] = 1,
    limit: Annotated[float, typer.Option(help="Time per problem and method, all starts together [s].", min=0.1)] = 60.0,
) -> None:
    """Solve mathematical programs with complementarity constraints, each in a process with limits."""
    chosen = methods or list(METHODS)
    for name in chosen:
        method(name)
    reference, console = read_reference(folder), Console()
    total, rows = len(problem_files(folder)) * len(chosen), list[Row]()
    collection = run_collection(folder, chosen, starts, Limits(seconds=limit))
    with console.status("") as status:
        for row in write_rows(collection, out):
            rows.append(row)
            status.update(f"{len(rows)} of {total}: {row.problem} by {row.method}")
    console.print(_summary(rows, chosen, reference))
    figure = out.with_suffix(".svg")
    panels = {
        "iterations": performance_profiles(rows, lambda row: row.iterations),
        "time": performance_profiles(rows, lambda row: row.seconds),
    }
    try:
        figure.write_text(profile_figure(panels), encoding="utf-8")
    except OSError as error:
        raise OutputError(f"{figure}: {error.strerror}") from error
    console.print(f"written: {out}, {figure}")


def _summary(rows: Sequence[Row], methods: Sequence[str], reference: Mapping[str, float]) -> Table:
    table = Table(title="Complementarity problems by method")
    for column in ("method", "problems", "certified", "best known reached", "iterations", "seconds"):
        table.add_column(column, justify="left" if column == "method" else "right")
    for name in methods:
        own = [row for row in rows if row.method == name]
        known = [row for row in own if row.problem in reference]
        reached = sum(row.reaches(reference[row.problem]) for row in known)
        table.add_row(
            name,
            str(len(own)),
            str(sum(row.solved for row in own)),
            f"{reached} of {len(known)}" if known else "no reference.csv",
            str(sum(row.iterations for row in own)),
            f"{sum(row.seconds for row in own):.1f}",
        )
    return table
