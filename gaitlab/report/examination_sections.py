"""The clinical examination: a page of its own, and in short beside the curves that it explains."""

from collections.abc import Sequence

from ..clinical.examination import Examination, JointRange, Spasticity, Strength
from .blocks import Block, Section, Table, bullets, missing, paragraph, section, table
from .formatting import ABSENT
from .source import Source

NO_EXAMINATION = "no examination file was given (gaitlab report --examination FILE)"
_Entry = JointRange | Strength | Spasticity


def beside_curves(found: Examination | None) -> tuple[Block, ...]:
    """Ranges, strength, spasticity and GMFCS level in one table, to be read together with the curves.

    Nothing where none was examined: the page of the examination says so.
    """
    if found is None:
        return ()
    rows = [(f"{e.joint} {e.motion}, passive [deg]", _degrees(e.left), _degrees(e.right)) for e in found.ranges]
    rows += [(f"{e.muscle}, strength (0 to 5)", _grade(e.left), _grade(e.right)) for e in found.strength]
    rows += [(f"{e.muscle}, modified Ashworth", _grade(e.left), _grade(e.right)) for e in found.spasticity]
    level = paragraph(f"GMFCS {_level(found)}.", "note") if found.patient.gmfcs is not None else None
    shown = table(("", "left", "right"), rows, "Clinical examination", "sides beside") if rows else None
    return tuple(block for block in (shown, level) if block is not None)


def examination_sections(source: Source) -> tuple[Section, ...]:
    """What the examiner found, in tables of left and right."""
    title = "Clinical examination and condition"
    found = source.examination
    if found is None:
        return (section(title, missing("clinical examination and condition", NO_EXAMINATION)),)
    tables = [*_ranges(found), *_graded(found.strength, "Strength, grade 0 to 5 (MRC)")]
    tables += _graded(found.spasticity, "Spasticity, modified Ashworth scale")
    absent = [
        words
        for words, entries in (
            ("joint ranges", found.ranges),
            ("strength", found.strength),
            ("spasticity", found.spasticity),
        )
        if not entries
    ]
    notes = bullets(found.notes) if found.notes else None
    gap = missing(", ".join(absent), "the examination file holds none") if absent else None
    return (section(title, _condition(found), *tables, notes, gap),)


def _condition(found: Examination) -> Table:
    rows = [
        ("Diagnosis", found.patient.diagnosis or "not stated"),
        ("GMFCS", _level(found)),
        ("Examined by", found.session.examiner or "not stated"),
        ("Footwear", found.condition.footwear or "not stated"),
        ("Orthosis", found.condition.orthosis or "not stated"),
        ("Walking aid", found.condition.walking_aid or "not stated"),
        *([("Remark", found.condition.note)] if found.condition.note else []),
    ]
    return table(("", ""), rows, kind="facts")


def _ranges(found: Examination) -> list[Block]:
    rows = [
        (f"{entry.joint} {entry.motion}", _degrees(entry.left), _degrees(entry.right)) + _remark(entry, found.ranges)
        for entry in found.ranges
    ]
    return _two_sided(rows, "Passive joint ranges [deg]")


def _graded(entries: Sequence[Strength | Spasticity], caption: str) -> list[Block]:
    rows = [(entry.muscle, _grade(entry.left), _grade(entry.right)) + _remark(entry, entries) for entry in entries]
    return _two_sided(rows, caption)


def _level(found: Examination) -> str:
    return "not stated" if found.patient.gmfcs is None else f"level {'I II III IV V'.split()[found.patient.gmfcs - 1]}"


def _degrees(value: float | None) -> str:
    return ABSENT if value is None else f"{value:g}"


def _grade(value: str | int | None) -> str:
    return ABSENT if value is None else str(value)


def _remark(entry: _Entry, all_of_them: Sequence[_Entry]) -> tuple[str, ...]:
    """A cell of its own where any entry has a remark."""
    return (entry.note,) if any(other.note for other in all_of_them) else ()


def _two_sided(rows: Sequence[tuple[str, ...]], caption: str) -> list[Block]:
    if not rows:
        return []
    header = ("", "left", "right", "remark")[: len(rows[0])]
    return [table(header, rows, caption, "sides")]
