"""The report of an analysis as PDF and HTML page, a draft until it is signed."""

from typing import Any

import msgspec

from ...pipelines.progress import Progress, Step
from ...report.build import FORMATS, Format, ReportOptions, build_report
from ...report.colours import Palette
from ...report.edition import DRAFT
from ...report.pages import KEYS
from ...report.source import EXAMINATION, read_source
from ..request import Work
from .outcome import Outcome, settings_of
from .prediction import RESULT


class ReportOrder(msgspec.Struct, frozen=True, kw_only=True):
    """Settings of the job; empty choices stand for all."""

    formats: tuple[Format, ...] = FORMATS
    pages: tuple[str, ...] = ()
    colours: Palette = "standard"
    examination: dict[str, Any] = {}
    """As `gaitlab report --examination` reads it."""


def run(work: Work, progress: Progress) -> Outcome:
    """Report on the files of the role `result`."""
    order = settings_of(work, ReportOrder)
    folder = work.folder / "inputs" / RESULT
    if order.examination:
        (folder / EXAMINATION).write_bytes(msgspec.json.encode(order.examination))
    progress(Step(stage="report"))
    options = ReportOptions(formats=order.formats, pages=order.pages or KEYS, colours=order.colours)
    made = build_report(read_source(folder), options, DRAFT)
    for ending, content in made.items():
        (work.out / f"report.{ending}").write_bytes(content)
    return Outcome(summary={"formats": sorted(made)})
