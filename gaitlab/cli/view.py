"""`gaitlab view`: 3D playback of an analysis."""

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InvalidRecording
from ..viewer.session import view as open_viewer


def view(
    directory: Annotated[Path, typer.Argument(help="Folder written by gaitlab analyse.")],
    port: Annotated[int, typer.Option(help="Port on this machine.", min=1, max=65535)] = 8080,
) -> None:
    """Play the measured and the model-optimal walk in the browser, until interrupted."""
    if not directory.is_dir():
        raise InvalidRecording(f"{directory} is not a folder: give the --out folder of gaitlab analyse")
    open_viewer(directory, port, on_open=_tell)


def _tell(address: str) -> None:
    typer.echo(f"{address} shows the walk; Ctrl+C ends it")
