"""The report as PDF, typeset by typst: same input same bytes, nothing is read but the fonts."""

import json
import re
from collections.abc import Iterable, Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path

import matplotlib
import typst

from ..errors import OutputError
from .blocks import Block, Bullets, Page, Picture, Section, Table
from .edition import INTENDED_USE, Edition
from .svg import standalone

TYPESETTER = f"typst {version('typst')}"
_WIDTH = 180.0
"""Between the margins [mm]."""
_HEIGHT = 232.0
"""Highest figure [mm]."""
_LONG = re.compile(r"\S{33,}")
_PIECE = 16
_BREAK = "\u200b"
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f\ud800-\udfff]")
_VIEW = re.compile(r'viewBox="0 0 ([0-9.]+) ([0-9.]+)"')
_TITLE = re.compile(r"<title>(.*?)</title>", re.DOTALL)
# typst brings no sans-serif face, and what a machine has installed must not change a report.
FONTS = Path(matplotlib.get_data_path()) / "fonts" / "ttf"


def pdf_report(name: str, pages: Sequence[Page], edition: Edition) -> bytes:
    """Typeset the report.

    Args:
        name: Pseudonym of the person, or the name of the result.
        pages: What it holds.
        edition: Its state, printed on every page.

    Raises:
        OutputError: typst refuses what gaitlab wrote.
    """
    return typeset(typst_source(name, pages, edition))


def typeset(source: str) -> bytes:
    """PDF of a document in typst's language; raises OutputError."""
    try:
        return typst.compile(source.encode(), format="pdf", font_paths=_fonts(), timestamp=0)
    except typst.TypstError as error:
        raise OutputError(f"the report cannot be typeset: {error}") from error


@cache
def _fonts() -> typst.Fonts:
    return typst.Fonts(include_system_fonts=False, include_embedded_fonts=True, font_paths=[str(FONTS)])


def typst_source(name: str, pages: Sequence[Page], edition: Edition) -> str:
    """The report in typst's language."""
    style = (Path(__file__).parent / "report.typ").read_text(encoding="utf-8")
    title = f"Gait report: {name}"
    shown = f"title: {_string(title)}, state: {_string(edition.words)}, use: {_string(INTENDED_USE)}"
    parts = [style, f"#show: paper.with({shown}, signed: {str(bool(edition.signed_by)).lower()})", _heading(1, title)]
    trial = ""
    for number, page in enumerate(pages):
        if number and (page.is_large or page.trial != trial):
            parts.append("#pagebreak(weak: true)")
        if page.trial != trial:
            parts.append(_heading(1, f"Trial: {page.trial}"))
        trial = page.trial
        parts += [_section(section) for section in page.sections]
    return "\n".join(parts) + "\n"


def _heading(level: int, words: str) -> str:
    return f"#heading(level: {level}, {_string(words)})"


def _section(section: Section) -> str:
    body = "\n".join([_heading(2, section.title), *(_block(block, section.kind) for block in section.blocks)])
    return f"#box-of({_string(section.kind)})[\n{body}\n]"


def _block(block: Block, kind: str) -> str:
    if isinstance(block, Picture):
        return _picture(block.markup, kind == "unsolved")
    if isinstance(block, Table):
        rows = _array(_array(map(_string, row)) for row in block.rows)
        head = _array(map(_string, block.header))
        return f"#cells({_string(block.kind)}, {_string(block.caption)}, {head}, {rows})"
    if isinstance(block, Bullets):
        return f"#items({_string(block.kind)}, {_array(map(_string, block.items))})"
    return f"#words({_string(block.kind)}, {_string(block.words)})"


def _picture(markup: str, faded: bool) -> str:
    found, named = _VIEW.search(markup), _TITLE.search(markup)
    width, height = (float(v) for v in found.groups()) if found else (1.0, 1.0)
    shown = min(_WIDTH, _HEIGHT * width / height)
    content = standalone(markup, "'DejaVu Sans'")
    if faded:
        content = content.replace("<svg", '<svg opacity="0.45"', 1)
    title = _string(named.group(1) if named else "figure")
    return f"#drawing({_string(content)}, {title}, {shown:.1f}mm)"


def _array(values: Iterable[str]) -> str:
    return "(" + "".join(f"{value}, " for value in values) + ")"


def _string(words: str) -> str:
    """A string of typst's language; long words may break."""
    if not words.startswith("<svg"):
        words = _LONG.sub(_breakable, words)
    return json.dumps(_CONTROL.sub("", words), ensure_ascii=False)


def _breakable(match: re.Match[str]) -> str:
    word = match.group()
    return _BREAK.join(word[k : k + _PIECE] for k in range(0, len(word), _PIECE))
