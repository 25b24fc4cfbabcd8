"""Blanks what a C3D file says of a person: bytes of its parameter section change in place, lengths and data stay.

Works without the native parser, so that a service may do it anywhere. Source: C3D file format, parameter section
(c3d.org): records of name length, group number, name, distance to the next record, and for parameters type, sizes,
values. Every length is checked against the end of the section before it is used.
"""

import re
import struct
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.header import BLOCK, MAGIC, MIPS
from gaitlab.mocap.privacy import PERSONAL

HEAD = 4  # bytes before the first record
CHARACTER = -1
ALWAYS = re.compile(r"SUBJECTS:(NAMES|LABEL_PREFIXES)\d*$")
LABELS = re.compile(r"(POINT|ANALOG):LABELS\d*$")


@dataclass(frozen=True, kw_only=True)
class _Parameter:
    """Place of one parameter's values in the section."""

    name: str
    """GROUP:NAME."""
    kind: int
    """-1 for texts."""
    sizes: tuple[int, ...]
    start: int
    end: int


def blank_personal_entries(path: Path) -> tuple[str, ...]:
    """Blank names, prefixes of labels and dates of birth in the file itself; returns the names of changed entries.

    Raises:
        InvalidRecording: The parameter section cannot be walked through.
    """
    with path.open("r+b") as file:
        start = file.read(BLOCK)
        if len(start) < BLOCK or start[1] != MAGIC or start[0] == 0:
            raise InvalidRecording(
                f"{path}: this is not a C3D file (it does not start as one); export the trial as C3D"
            )
        place = (start[0] - 1) * BLOCK
        file.seek(place)
        head = file.read(HEAD)
        blocks = head[2] if len(head) == HEAD else 0
        section = bytearray(head + file.read(max(blocks * BLOCK - HEAD, 0)))
        changed = _blank(section, path)
        if changed:
            file.seek(place)
            file.write(section)
    return changed


def _blank(section: bytearray, path: Path) -> tuple[str, ...]:
    changed: list[str] = []
    try:
        for parameter in _parameters(section):
            before = bytes(section[parameter.start : parameter.end])
            after = _without_person(parameter, before)
            if after != before:
                section[parameter.start : parameter.end] = after
                changed.append(parameter.name)
    except (IndexError, struct.error) as error:
        raise InvalidRecording(
            f"{path}: the parameters of the C3D file are damaged, so nothing was blanked; export the trial again"
        ) from error
    return tuple(changed)


def _without_person(parameter: _Parameter, values: bytes) -> bytes:
    if LABELS.search(parameter.name) and parameter.kind == CHARACTER and len(parameter.sizes) == 2:
        width = parameter.sizes[0]
        labels = [values[at : at + width] for at in range(0, len(values), width)] if width else []
        return b"".join(label.rpartition(b":")[2].ljust(width) for label in labels)
    if ALWAYS.search(parameter.name) or PERSONAL.search(parameter.name.partition(":")[2]):
        return (b" " if parameter.kind == CHARACTER else b"\0") * len(values)
    return values


def _parameters(section: bytearray) -> Generator[_Parameter]:
    """All parameters; those that stand before the definition of their group are looked at, too."""
    records = list(_records(section))
    groups = {-number: name for number, name, _ in records if number < 0}
    for number, name, place in records:
        if number > 0:
            yield _parameter(section, f"{groups.get(number, '')}:{name}", place)


def _records(section: bytearray) -> Generator[tuple[int, str, int]]:
    """Group number (negative: defines the group), name, and where the record's content begins."""
    order = ">" if section[3] == MIPS else "<"
    place = HEAD
    while place + 2 <= len(section) and section[place] != 0:
        # A negative length marks a locked record.
        length = abs(struct.unpack_from("b", section, place)[0])
        number: int = struct.unpack_from("b", section, place + 1)[0]
        name = bytes(section[place + 2 : place + 2 + length]).decode("latin-1").upper()
        pointer = place + 2 + length
        distance: int = struct.unpack_from(order + "h", section, pointer)[0]
        yield number, name, pointer + 2
        if distance <= 0:
            return
        place = pointer + distance


def _parameter(section: bytearray, name: str, place: int) -> _Parameter:
    kind: int = struct.unpack_from("b", section, place)[0]
    n_sizes = section[place + 1]
    sizes = tuple(section[place + 2 : place + 2 + n_sizes])
    start = place + 2 + n_sizes
    end = start + abs(kind)
    for size in sizes:
        end = start + (end - start) * size
    if end > len(section):
        raise IndexError(name)
    return _Parameter(name=name, kind=kind, sizes=sizes, start=start, end=end)
