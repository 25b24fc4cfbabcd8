"""Clinical examination and condition of a session, as the examiner wrote them down in a TOML or JSON file.

There is no field for a name or a birth date: the report goes by a pseudonym.
"""

import datetime
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import msgspec

from ..errors import InvalidSubject

Grade = str | int | None
STRENGTH = ("0", "1", "2", "3", "4", "5")
"""Grades of manual muscle testing (Medical Research Council); with + or - behind them, too."""
SPASTICITY = ("0", "1", "1+", "2", "3", "4")
"""Grades of the modified Ashworth scale (Bohannon & Smith 1987)."""
WIDEST = 180.0  # [deg]


class Patient(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Who, without saying who."""

    pseudonym: str = ""
    diagnosis: str = ""
    gmfcs: Literal[1, 2, 3, 4, 5] | None = None
    """Level of the Gross Motor Function Classification System."""


class SessionFacts(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When and where."""

    date: datetime.date | None = None
    laboratory: str = ""
    examiner: str = ""


class Condition(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What was worn and used."""

    footwear: str = ""
    orthosis: str = ""
    walking_aid: str = ""
    note: str = ""


class JointRange(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Passive range of one motion [deg]."""

    joint: str
    motion: str
    left: float | None = None
    right: float | None = None
    note: str = ""


class Strength(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Manual muscle test, grades of `STRENGTH`."""

    muscle: str
    left: Grade = None
    right: Grade = None
    note: str = ""


class Spasticity(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Resistance to passive motion, grades of `SPASTICITY`."""

    muscle: str
    left: Grade = None
    right: Grade = None
    note: str = ""


class Examination(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Everything of the file; every part may be absent."""

    patient: Patient = Patient()
    session: SessionFacts = SessionFacts()
    condition: Condition = Condition()
    ranges: list[JointRange] = []
    strength: list[Strength] = []
    spasticity: list[Spasticity] = []
    notes: list[str] = []


def read_examination(path: Path) -> Examination:
    """Read and check a file; its ending tells TOML from JSON.

    Raises:
        InvalidSubject: The file is absent, has an unknown field or a grade that the scale does not have.
    """
    try:
        content = path.read_bytes()
        if path.suffix.lower() == ".toml":
            found = msgspec.toml.decode(content, type=Examination)
        else:
            found = msgspec.json.decode(content, type=Examination)
    except OSError as error:
        raise InvalidSubject(f"examination {path.name} cannot be read ({error.strerror})") from error
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        fields = ", ".join(Examination.__struct_fields__)
        raise InvalidSubject(
            f"examination {path.name}: {error}; it may hold {fields}, and no name or birth date of a person"
        ) from error
    _check(found, path.name)
    return found


def check_examination(value: Mapping[str, Any]) -> dict[str, Any]:
    """An examination that was typed into a form, as plain JSON.

    Raises:
        InvalidSubject: It has an unknown field or a grade that the scale does not have.
    """
    try:
        found = msgspec.convert(dict(value), Examination)
    except msgspec.ValidationError as error:
        raise InvalidSubject(f"examination: {error}; no name or birth date of a person belongs here") from error
    _check(found, "of the form")
    return msgspec.to_builtins(found)


def schema() -> dict[str, Any]:
    """JSON schema of an examination."""
    return msgspec.json.schema(Examination)


def encode_examination(examination: Examination) -> bytes:
    """Indented JSON; the same examination gives the same bytes."""
    return msgspec.json.format(msgspec.json.encode(examination), indent=2) + b"\n"


def _check(examination: Examination, name: str) -> None:
    for entry in examination.ranges:
        for value in (entry.left, entry.right):
            if value is not None and not abs(value) <= WIDEST:
                raise InvalidSubject(f"examination {name}: {entry.joint} {entry.motion} is {value:g} deg")
    for muscle in examination.strength:
        allowed = {grade + sign for grade in STRENGTH for sign in ("", "+", "-")}
        _check_grades(muscle, allowed, f"examination {name}: strength", "0 to 5, with + or -")
    for muscle in examination.spasticity:
        _check_grades(muscle, set(SPASTICITY), f"examination {name}: spasticity", ", ".join(SPASTICITY))


def _check_grades(muscle: Strength | Spasticity, allowed: set[str], where: str, words: str) -> None:
    for grade in (muscle.left, muscle.right):
        if grade is not None and str(grade) not in allowed:
            raise InvalidSubject(f"{where} of {muscle.muscle} is {grade}: give {words}")
