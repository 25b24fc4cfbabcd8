"""The commands of the server on their own: they start without the packages that compute."""

import sys

import typer

from .ending import run_app
from .serve import SERVER_COMMANDS

app = typer.Typer(name="gaitlab", add_completion=False, pretty_exceptions_enable=False)
for command in SERVER_COMMANDS:
    app.command()(command)


def main(arguments: list[str] | None = None) -> None:
    """Run one of the server's commands; `arguments` default to those of the process."""
    sys.exit(run_app(app, arguments))
