"""`gaitlab inspect`: what is in a C3D file."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from ..pipelines.inspect import Inspection, inspect_file


def inspect(files: Annotated[list[Path], typer.Argument(help="C3D files.", show_default=False)]) -> None:
    """Show markers, gaps, events, force plates and body parameters of C3D files."""
    console = Console()
    for file in files:
        console.print(_table(inspect_file(file)))


def _table(inspection: Inspection) -> Table:
    table = Table(show_header=False, title=inspection.name)
    for title, text in inspection.rows:
        table.add_row(title, text)
    return table
