"""Numbers and words of an .xlsx workbook, by the standard library."""

import re
import zipfile
from pathlib import Path
from xml.etree import ElementTree

from ..errors import InvalidReference

Cell = str | float | None
Sheet = list[list[Cell]]
MOST_BYTES = 100_000_000
"""Unpacked size above which a sheet is refused."""
MOST_COLUMNS = 16_384  # of the format
_SPACE = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"


def read_sheets(path: Path) -> list[Sheet]:
    """Cells of every sheet, rows of equal length, None where empty.

    Raises:
        InvalidReference: The file is absent, or is no such workbook.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            names = [n for n in archive.namelist() if re.fullmatch(r"xl/worksheets/[^/]+\.xml", n)]
            if any(archive.getinfo(name).file_size > MOST_BYTES for name in names):
                raise InvalidReference(f"{path.name}: a sheet is larger than {MOST_BYTES // 1_000_000} MB")
            words = _shared_words(archive)
            return [_sheet(ElementTree.fromstring(archive.read(name)), words) for name in sorted(names)]
    except OSError as error:
        raise InvalidReference(f"{path.name} cannot be read ({error.strerror})") from error
    except (zipfile.BadZipFile, ElementTree.ParseError, KeyError, IndexError, ValueError) as error:
        raise InvalidReference(f"{path.name} is no .xlsx workbook ({error}); save it as one") from error


def _shared_words(archive: zipfile.ZipFile) -> list[str]:
    if "xl/sharedStrings.xml" not in archive.namelist():
        return []
    root = ElementTree.fromstring(archive.read("xl/sharedStrings.xml"))
    return ["".join(part.text or "" for part in item.iter(f"{_SPACE}t")) for item in root.iter(f"{_SPACE}si")]


def _sheet(root: ElementTree.Element, words: list[str]) -> Sheet:
    cells: dict[tuple[int, int], Cell] = {}
    for cell in root.iter(f"{_SPACE}c"):
        row, column = _place(cell.get("r", ""))
        value = _value(cell, words)
        if value is not None:
            cells[row, column] = value
    if not cells:
        return []
    last = max(row for row, _ in cells)
    width = max(column for _, column in cells) + 1
    sheet: Sheet = [[None] * width for _ in range(last + 1)]
    for (row, column), value in cells.items():
        sheet[row][column] = value
    return sheet


def _place(reference: str) -> tuple[int, int]:
    found = re.fullmatch(r"([A-Z]{1,3})([0-9]{1,7})", reference)
    if found is None:
        raise ValueError(f"cell without a place: {reference!r}")
    column = 0
    for letter in found[1]:
        column = 26 * column + ord(letter) - ord("A") + 1
    if column > MOST_COLUMNS:
        raise ValueError(f"column out of range: {reference}")
    return int(found[2]) - 1, column - 1


def _value(cell: ElementTree.Element, words: list[str]) -> Cell:
    if cell.get("t") == "inlineStr":
        return "".join(part.text or "" for part in cell.iter(f"{_SPACE}t"))
    text = cell.findtext(f"{_SPACE}v")
    if text is None:
        return None
    if cell.get("t") == "s":
        return words[int(text)]
    return text if cell.get("t") in ("str", "e", "b") else float(text)
