"""The report as one self-contained HTML page: same input same bytes, nothing to load."""

from collections.abc import Sequence
from html import escape
from itertools import groupby
from pathlib import Path

from .blocks import Block, Bullets, Page, Picture, Section, Table
from .edition import INTENDED_USE, Edition
from .svg import style_sheet

# No script, no image, no request: what a hostile file name could smuggle in would not run.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"


def html_report(name: str, pages: Sequence[Page], edition: Edition) -> str:
    """Write the report.

    Args:
        name: Pseudonym of the person, or the name of the result.
        pages: What it holds.
        edition: Its state, printed on every page.
    """
    title = escape(f"Gait report: {name}")
    style = (Path(__file__).parent / "report.css").read_text(encoding="utf-8") + style_sheet(".figure ")
    head = (
        '<meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{escape(_POLICY)}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}</title><style>{style}</style>"
    )
    header = _tag("header", _tag("h1", title) + _paragraph(edition.words, "edition") + _paragraph(INTENDED_USE, "use"))
    trials = list(dict.fromkeys(page.trial for page in pages if page.trial))
    body = "".join(
        _of_trial(trial, [_page(page, edition) for page in own], trials)
        for trial, own in groupby(pages, lambda page: page.trial)
    )
    main = _tag("main", header + _contents(pages, trials) + body)
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head><body>{main}</body></html>\n'


def _contents(pages: Sequence[Page], trials: Sequence[str]) -> str:
    links = [f'<a href="#{escape(page.key)}">{escape(page.title)}</a>' for page in pages if not page.trial]
    links += [f'<a href="#trial-{number}">Trial {escape(trial)}</a>' for number, trial in enumerate(trials, 1)]
    return _tag("nav", " · ".join(links))


def _of_trial(trial: str, pages: Sequence[str], trials: Sequence[str]) -> str:
    if not trial:
        return "".join(pages)
    title = _tag("h1", f"Trial: {escape(trial)}")
    return _tag("article", title + "".join(pages), identifier=f"trial-{trials.index(trial) + 1}")


def _page(page: Page, edition: Edition) -> str:
    footer = _tag("footer", escape(f"{edition.words}. {INTENDED_USE}"))
    kind = "paper large" if page.is_large else "paper"
    return _tag("section", "".join(map(_section, page.sections)) + footer, kind, "" if page.trial else page.key)


def _section(section: Section) -> str:
    return _tag("section", _tag("h2", escape(section.title)) + "".join(map(_block, section.blocks)), section.kind)


def _block(block: Block) -> str:
    if isinstance(block, Picture):
        return block.markup
    if isinstance(block, Table):
        return _table(block)
    if isinstance(block, Bullets):
        return _tag("ul", "".join(_tag("li", escape(item)) for item in block.items), block.kind)
    return _paragraph(block.words, block.kind)


def _table(table: Table) -> str:
    head = _tag("thead", _tag("tr", "".join(f'<th scope="col">{escape(cell)}</th>' for cell in table.header)))
    body = "".join(
        _tag("tr", f'<th scope="row">{escape(first)}</th>' + "".join(_tag("td", escape(cell)) for cell in cells))
        for first, *cells in table.rows
    )
    caption = _tag("caption", escape(table.caption)) if table.caption else ""
    return _tag("div", _tag("table", caption + head + _tag("tbody", body), table.kind), "scroll")


def _paragraph(words: str, kind: str = "") -> str:
    return _tag("p", escape(words), kind)


def _tag(name: str, markup: str, kind: str = "", identifier: str = "") -> str:
    """Wrap trusted markup in an element, with a class and an id if given."""
    attributes = (f' class="{escape(kind)}"' if kind else "") + (f' id="{escape(identifier)}"' if identifier else "")
    return f"<{name}{attributes}>{markup}</{name}>"
