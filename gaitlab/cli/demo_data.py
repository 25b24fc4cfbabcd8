"""`gaitlab demo-data`: simulate the demo recordings."""

from pathlib import Path
from typing import Annotated

import typer

from ..pipelines.demo_data import write_demo_data


def demo_data(directory: Annotated[Path, typer.Argument(help="Folder to write into; made if absent.")]) -> None:
    """Simulate the demo recordings from known weights and write them as C3D files, the same every time."""
    write_demo_data(directory)
    typer.echo(f"demo recordings: {directory}")
