"""Tables and figures of several results."""

from collections.abc import Mapping
from typing import Any

from ...clinical.comparison import MINIMAL, Member, compare
from ...clinical.document import read_document
from ...pipelines.compare import write_tables
from ...pipelines.progress import Progress, Step
from ...report.comparison_figures import figures
from ..request import Work
from .outcome import Outcome


def run(work: Work, progress: Progress) -> Outcome:
    """Compare the files of the role `result`; their extra entries may hold a label and a group."""
    progress(Step(stage="comparing"))
    members = [_member(work, each) for each in work.inputs if each["role"] == "result"]
    comparison = compare(members, str(work.settings.get("baseline") or ""), MINIMAL)
    write_tables(comparison, work.out, bool(work.settings.get("parquet")))
    for name, markup in figures(comparison).items():
        (work.out / f"{name}.svg").write_text(markup, encoding="utf-8")
    return Outcome(summary={"members": len(members), "baseline": comparison.baseline})


def _member(work: Work, each: Mapping[str, Any]) -> Member:
    extra: Mapping[str, Any] = each.get("extra", {})
    label = str(extra.get("label") or each["source"])
    document = read_document(work.folder / "inputs" / each["name"])
    return Member(label=label, group=str(extra.get("group") or label), document=document)
