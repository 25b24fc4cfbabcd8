"""`gaitlab report`: the clinical report of a result folder, as PDF and HTML; sign it, amend it, check it."""

from pathlib import Path
from typing import Annotated, Any, cast, get_args

import typer
from typer.core import TyperGroup

from ..errors import OutputError
from ..pipelines.output import make_folder
from ..report.build import FORMATS, Format, ReportOptions
from ..report.colours import Palette
from ..report.files import ReportFolders, amend_report, draft_report, problems_of, sign_report
from ..report.pages import KEYS

_MAKE = "make"
_Folder = Annotated[Path, typer.Argument(help="Result folder, from 'gaitlab analyse'.", show_default=False)]
_Out = Annotated[Path | None, typer.Option(help="Folder of the report; default the result folder.")]
_Examination = Annotated[
    Path | None, typer.Option(help="Clinical examination and condition, TOML or JSON (docs/report.md).")
]


class _MakesByDefault(TyperGroup):
    """`gaitlab report DIR` is short for `gaitlab report make DIR`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if args and args[0] not in self.commands and args[0] not in ctx.help_option_names:
            args = [_MAKE, *args]
        return super().parse_args(ctx, args)


report = typer.Typer(
    name="report",
    help="The clinical report of a result folder: gaitlab report DIR makes it, the commands below sign and amend it.",
    cls=_MakesByDefault,
)


@report.command(name=_MAKE)
def make(
    folder: _Folder,
    out: _Out = None,
    formats: Annotated[str, typer.Option("--format", help="pdf, html, or both.")] = ",".join(FORMATS),
    colours: Annotated[
        Palette, typer.Option(help="green: right side green; safe: for colour-blind eyes.")
    ] = "standard",
    pages: Annotated[str, typer.Option(help=f"Pages to show, of {', '.join(KEYS)}.")] = "all",
    examination: _Examination = None,
) -> None:
    """Make the report as a draft, or make the draft anew."""
    options = ReportOptions(formats=_formats(formats), pages=_pages(pages), colours=colours)
    _say(draft_report(_folders(folder, out), options, examination))


@report.command()
def sign(
    folder: _Folder,
    by: Annotated[str, typer.Option(help="Who signs.")],
    out: _Out = None,
) -> None:
    """Sign the draft; the signed report is never overwritten."""
    _say(sign_report(_folders(folder, out), by))


@report.command()
def amend(
    folder: _Folder,
    by: Annotated[str, typer.Option(help="Who amends.")],
    reason: Annotated[str, typer.Option(help="Why; printed on every page.")],
    out: _Out = None,
    examination: _Examination = None,
) -> None:
    """Open the next version of a signed report, as a draft that has to be signed."""
    _say(amend_report(_folders(folder, out), by, reason, examination))


@report.command()
def check(folder: _Folder, out: _Out = None) -> None:
    """Compare report and results with the fingerprints in report.json."""
    problems = problems_of(_folders(folder, out))
    if problems:
        raise OutputError("; ".join(problems))
    typer.echo("report and results are what report.json says")


def _folders(folder: Path, out: Path | None) -> ReportFolders:
    make_folder(out or folder)
    return ReportFolders(results=folder, report=out or folder)


def _formats(words: str) -> tuple[Format, ...]:
    asked = [word.strip() for word in words.split(",") if word.strip()]
    known = get_args(Format)
    if not asked or any(word not in known for word in asked):
        raise OutputError(f"--format {words} is not known; give {' or '.join(known)}, or both with a comma between")
    return tuple(cast("Format", word) for word in dict.fromkeys(asked))


def _pages(words: str) -> tuple[str, ...]:
    return KEYS if words == "all" else tuple(word.strip() for word in words.split(",") if word.strip())


def _say(paths: tuple[Path, ...]) -> None:
    for path in paths:
        typer.echo(f"report: {path}")
