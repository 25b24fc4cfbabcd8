"""Collects the commands."""

import sys
from typing import Annotated

import typer

from .. import __version__
from .analyse import analyse
from .benchmark import benchmark
from .compare import compare_results
from .demo import demo, demo_clinic
from .demo_data import demo_data
from .ending import run_app
from .export import export_results
from .inspect import inspect
from .norms import norms
from .openapi import openapi
from .predict import predict
from .report import report
from .schema import schema
from .serve import SERVER_COMMANDS
from .view import view

app = typer.Typer(
    name="gaitlab",
    help="Why does this patient walk this way? C3D files in, criterion weights and 3D playback out.",
    add_completion=False,
    pretty_exceptions_enable=False,
    no_args_is_help=False,
)
for command in (analyse, inspect, view, schema, demo, *SERVER_COMMANDS, openapi):
    app.command()(command)
app.command(name="demo-clinic")(demo_clinic)
app.command(name="demo-data")(demo_data)
app.command(name="compare")(compare_results)
app.command()(predict)
app.command(name="export")(export_results)
app.add_typer(benchmark)
app.add_typer(norms)
app.add_typer(report)


@app.callback(invoke_without_command=True)
def options(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """Why does this patient walk this way? C3D files in, criterion weights and 3D playback out."""
    if version:
        typer.echo(__version__)
        raise typer.Exit
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; `arguments` default to those of the process."""
    sys.exit(run(arguments))


def run(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    return run_app(app, arguments)
