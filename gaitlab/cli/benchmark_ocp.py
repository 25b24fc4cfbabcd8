"""`gaitlab benchmark ocp`: the optimal control problems of Hatz (2014), forwards and backwards."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from ..benchmarks.ocp_collection import BENCHMARKS, benchmark
from ..errors import NotConverged, OutputError
from ..pipelines.benchmark_tables import (
    FORWARD_COLUMNS,
    INVERSE_COLUMNS,
    PRINTED_FORWARD,
    PRINTED_INVERSE,
    as_csv,
    chosen,
    forward_rows,
    inverse_rows,
    published_rows,
)
from ..pipelines.inverse_methods import METHODS
from ..pipelines.ocp_benchmark import Comparison, compare
from ..report.benchmark_figure import arm_postures, path_in_plane, time_courses


def ocp(
    problem: Annotated[
        list[str] | None, typer.Option(help=f"Only this problem, repeatable: {', '.join(BENCHMARKS)}.")
    ] = None,
    method: Annotated[
        list[str] | None, typer.Option(help=f"Only this method, repeatable: {', '.join(METHODS)}.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for tables (CSV) and figures (SVG); made if absent.")] = Path(
        "gaitlab-benchmark"
    ),
) -> None:
    """Solve the thesis's optimal control problems, confirm the optima, and estimate their weights by every method."""
    problems, comparisons = [benchmark(name) for name in problem or BENCHMARKS], list[Comparison]()
    console = Console()
    for each in problems:
        console.print(f"{each.title} ...", style="dim")
        comparisons.append(compare(each, method or list(METHODS)))
    forward, inverse = forward_rows(comparisons), inverse_rows(comparisons) + published_rows(comparisons)
    console.print(as_table("Optimal control", PRINTED_FORWARD, chosen(FORWARD_COLUMNS, forward, PRINTED_FORWARD)))
    _remarks(console, comparisons)
    by_problem = sorted(inverse, key=lambda row: row[0])
    console.print(as_table("Inverse problems", PRINTED_INVERSE, chosen(INVERSE_COLUMNS, by_problem, PRINTED_INVERSE)))
    _failures(console, comparisons)
    files = {"optimal_control.csv": as_csv(FORWARD_COLUMNS, forward), "inverse.csv": as_csv(INVERSE_COLUMNS, inverse)}
    for comparison in comparisons:
        files |= _figures(comparison)
    write_files(files, out)
    console.print(f"written to {out}: {', '.join(files)}")
    _complain(comparisons)


def as_table(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """A table for the screen; long cells are folded."""
    table = Table(title=title, show_lines=True)
    for column in columns:
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table


def _remarks(console: Console, comparisons: Sequence[Comparison]) -> None:
    for row in forward_rows(comparisons):
        console.print(f"{row[0]}: {row[FORWARD_COLUMNS.index('status')]}; {row[-1]}.")


def _failures(console: Console, comparisons: Sequence[Comparison]) -> None:
    for comparison in comparisons:
        for inverse in comparison.inverses:
            if not inverse.result.converged:
                console.print(f"{comparison.forward.benchmark.name}, {inverse.method}: {inverse.result.reason}.")


def _figures(comparison: Comparison) -> dict[str, str]:
    forward, name = comparison.forward, comparison.forward.benchmark.name
    optimum = forward.course
    estimates = {inverse.method: inverse.course for inverse in comparison.inverses if inverse.result.converged}
    title = forward.benchmark.title
    files = {f"{name}.svg": time_courses(forward.benchmark.problem, optimum, estimates, comparison.measurements)}
    if name.startswith("reeds-shepp"):
        files[f"{name}-path.svg"] = path_in_plane(optimum, estimates, title)
    if name.startswith("polar-robot"):
        files[f"{name}-arm.svg"] = arm_postures(forward.result.trajectory, title)
    return files


def write_files(files: dict[str, str], folder: Path) -> None:
    """Write texts into a folder, made if absent; raises `errors.OutputError` where that is impossible."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError(f"cannot write into {folder}: {error.strerror}") from error


def _complain(comparisons: Sequence[Comparison]) -> None:
    failed = [each.forward.benchmark.name for each in comparisons if not each.forward.confirmed]
    if failed:
        raise NotConverged(f"optima that are not confirmed by the finer collocation: {', '.join(failed)}")
