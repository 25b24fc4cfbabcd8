"""Collects the commands, and turns every way to end into an exit code.

0: everything asked for was produced. 2: bad input, one sentence on stderr. 3: not converged, the results so far are
written and marked. 130: interrupted.
"""

import sys
from typing import Annotated

import typer

from .. import __version__
from ..errors import Cancelled, GaitlabError, NotConverged
from .analyse import analyse
from .benchmark import benchmark
from .compare import compare_results
from .demo import demo
from .demo_data import demo_data
from .inspect import inspect
from .norms import norms
from .report import report
from .schema import schema
from .view import view

BAD_INPUT = 2
NOT_CONVERGED = 3
INTERRUPTED = 130

app = typer.Typer(
    name="gaitlab",
    help="Why does this patient walk this way? C3D files in, criterion weights and 3D playback out.",
    add_completion=False,
    pretty_exceptions_enable=False,
    no_args_is_help=False,
)
for command in (analyse, inspect, view, schema, demo):
    app.command()(command)
app.command(name="demo-data")(demo_data)
app.command(name="compare")(compare_results)
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
    try:
        return int(app(arguments, standalone_mode=False) or 0)
    except NotConverged as error:
        return _say(str(error), NOT_CONVERGED)
    except (Cancelled, typer.Abort, KeyboardInterrupt):
        return _say("stopped before the end; nothing more is written", INTERRUPTED)
    except GaitlabError as error:
        return _say(str(error), BAD_INPUT)
    except typer.TyperException as error:
        return _say(f"{error.format_message().rstrip('.')}: see gaitlab --help", BAD_INPUT)


def _say(sentence: str, code: int) -> int:
    typer.echo(f"gaitlab: {sentence}", err=True)
    return code
