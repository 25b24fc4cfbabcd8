"""One report: what was read goes in, bytes come out; same input same bytes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from ..clinical.environment import environment
from .colours import Palette, recoloured
from .edition import Edition
from .html import html_report
from .pages import KEYS, report_pages
from .pdf import typeset, typst_source
from .source import Source

Format = Literal["pdf", "html"]
FORMATS: tuple[Format, ...] = ("pdf", "html")
PACKAGES = ("numpy", "matplotlib", "typst")
"""Besides gaitlab, what draws and typesets a report."""


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """What may be chosen about a report."""

    formats: tuple[Format, ...] = FORMATS
    pages: tuple[str, ...] = KEYS
    """Names of the pages to show."""
    colours: Palette = "standard"


def build_report(
    source: Source, options: ReportOptions, edition: Edition, program: Mapping[str, str] | None = None
) -> dict[Format, bytes]:
    """Draw and typeset a report.

    Args:
        source: What it is made from.
        options: What was chosen.
        edition: Its state, printed on every page.
        program: Versions and machine that make it; default those that run this.

    Returns:
        The report by format.

    Raises:
        OutputError: A page does not exist, or typst refuses what gaitlab wrote.
    """
    made_by = environment(PACKAGES) if program is None else program
    pages = report_pages(source, made_by, options.pages)
    made = dict[Format, bytes]()
    for wanted in options.formats:
        if wanted == "html":
            made[wanted] = recoloured(html_report(source.name, pages, edition), options.colours).encode()
        else:
            made[wanted] = typeset(recoloured(typst_source(source.name, pages, edition), options.colours))
    return made
