"""`report.json`: which versions of a report exist, who signed them, and the fingerprints of what they hold."""

import os
from pathlib import Path
from typing import Literal

import msgspec

from ..errors import OutputError
from .edition import Edition

LEDGER = "report.json"
FORMAT = "gaitlab-report-1"


class Version(msgspec.Struct, frozen=True, kw_only=True):
    """One version of a report."""

    number: int
    state: Literal["draft", "signed", "amended"]
    """A draft may be made anew; a signed version is kept as it is; it is amended once a later one is signed."""
    made_at: str
    """Coordinated universal time, ISO 8601."""
    gaitlab: str
    files: dict[str, str]
    """Name to SHA-256 of the report's own files."""
    sources: dict[str, str]
    """The same of the files that it was made from."""
    pages: list[str]
    colours: str
    signed_by: str = ""
    signed_at: str = ""
    amended_by: str = ""
    """Who asked for the change of the version before."""
    reason: str = ""
    """Why the version before was amended."""

    @property
    def edition(self) -> Edition:
        """What is printed on every page."""
        return Edition(
            number=self.number,
            signed_by=self.signed_by,
            signed_at=self.signed_at,
            amended_by=self.amended_by,
            reason=self.reason,
        )


class Ledger(msgspec.Struct, frozen=True, kw_only=True):
    """All versions, oldest first."""

    format: Literal["gaitlab-report-1"] = FORMAT
    versions: list[Version] = []

    @property
    def last(self) -> Version | None:
        """The newest version."""
        return self.versions[-1] if self.versions else None

    def with_last(self, version: Version) -> "Ledger":
        """The same with another newest version, in the place of the one of its number if there is one."""
        kept = [entry for entry in self.versions if entry.number != version.number]
        return Ledger(versions=[*kept, version])


def read_ledger(folder: Path) -> Ledger:
    """The ledger of a folder; an empty one where there is no report yet.

    Raises:
        OutputError: It cannot be read.
    """
    path = folder / LEDGER
    if not path.exists():
        return Ledger()
    try:
        return msgspec.json.decode(path.read_bytes(), type=Ledger)
    except (OSError, msgspec.DecodeError, UnicodeDecodeError) as error:
        raise OutputError(f"{path} is not a ledger of reports ({error}); restore it before making a report") from error


def write_ledger(ledger: Ledger, folder: Path) -> None:
    """Put a ledger in the place of the old one at once, so that a crash leaves one or the other.

    Raises:
        OutputError: The folder cannot be written.
    """
    path = folder / LEDGER
    new = path.with_suffix(".json.new")
    try:
        new.write_bytes(msgspec.json.format(msgspec.json.encode(ledger), indent=2) + b"\n")
        os.replace(new, path)
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def refuse_signed(folder: Path) -> None:
    """Keep the results that a signed report was made from.

    Raises:
        OutputError: The folder holds a signed report.
    """
    signed = [version for version in read_ledger(folder).versions if version.state != "draft"]
    if signed:
        raise OutputError(
            f"{folder} holds a report signed by {signed[-1].signed_by}; its results are kept as they are: "
            "write into another folder"
        )
