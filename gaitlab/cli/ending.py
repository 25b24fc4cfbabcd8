"""Turns every way to end into an exit code.

0: everything asked for was produced. 2: bad input, one sentence on stderr. 3: not converged, the results so far are
written and marked. 130: interrupted.
"""

import typer

from ..errors import Cancelled, GaitlabError, NotConverged

BAD_INPUT = 2
NOT_CONVERGED = 3
INTERRUPTED = 130


def run_app(app: typer.Typer, arguments: list[str] | None) -> int:
    """Run a command line and return the exit code."""
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
