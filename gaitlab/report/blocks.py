"""What a report is made of before it is HTML or PDF: pages of sections of paragraphs, lists, tables and pictures."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from .formatting import rows_of


@dataclass(frozen=True, kw_only=True)
class Paragraph:
    """Sentences."""

    words: str
    kind: str = ""
    """Look: lead, note, missing, alert, calm, stamp, caveat; empty for running text."""


@dataclass(frozen=True, kw_only=True)
class Bullets:
    """A list of sentences."""

    items: tuple[str, ...]
    kind: str = ""


@dataclass(frozen=True, kw_only=True)
class Table:
    """Cells in rows; the first cell of each row is its heading."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    kind: str = ""
    """Look: sides (second and third column in the sides' colours), sides beside (the
    same, in two halves on paper when it is long), facts (no header, text), inputs, text, narrow."""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A figure."""

    markup: str
    """One `svg` element with a `title` and a `viewBox`, as `svg.figure` makes it."""


LONG = 8
"""More rows than these make a page start on new paper."""
Block = Paragraph | Bullets | Table | Picture


@dataclass(frozen=True, kw_only=True)
class Section:
    """Blocks under a heading."""

    title: str
    blocks: tuple[Block, ...]
    kind: str = ""
    """Look: warnings (boxed), unsolved (figures faded); empty for the usual one."""


@dataclass(frozen=True, kw_only=True)
class Page:
    """One topic of the report."""

    key: str
    """Name by which it can be chosen, for instance `kinematics`."""
    sections: tuple[Section, ...]
    trial: str = ""
    """Trial that the page belongs to; empty for all together."""

    @property
    def title(self) -> str:
        """Heading of the first section."""
        return self.sections[0].title

    @property
    def is_large(self) -> bool:
        """Whether it starts on new paper: it holds a figure or begins with a long table."""
        blocks = [block for section in self.sections for block in section.blocks]
        rows = sum(len(block.rows) for block in self.sections[0].blocks if isinstance(block, Table))
        return rows > LONG or any(isinstance(block, Picture) for block in blocks)


def paragraph(words: str, kind: str = "") -> Paragraph:
    """Sentences."""
    return Paragraph(words=words, kind=kind)


def bullets(items: Iterable[str], kind: str = "") -> Bullets:
    """A list of sentences."""
    return Bullets(items=tuple(items), kind=kind)


def missing(what: str, why: str) -> Paragraph:
    """Say what the report does not show, and why."""
    return paragraph(f"Not shown: {what}. Reason: {why}.", "missing")


def table(header: Sequence[str], rows: Iterable[Sequence[str]], caption: str = "", kind: str = "") -> Table:
    """A table."""
    return Table(header=tuple(header), rows=tuple(tuple(row) for row in rows), caption=caption, kind=kind)


def facts(values: Mapping[str, object], caption: str = "") -> Table:
    """Table of everything in a JSON object, flattened."""
    return table(("", "value"), rows_of(values), caption, "facts")


def section(title: str, *blocks: Block | None, kind: str = "") -> Section:
    """A section of those blocks that are there."""
    return Section(title=title, blocks=tuple(block for block in blocks if block is not None), kind=kind)


def picture(markup: str | None) -> Picture | None:
    """A figure; None where there is none."""
    return Picture(markup=markup) if markup else None
