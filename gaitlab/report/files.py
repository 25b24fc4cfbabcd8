"""Reports as files of a folder: draft, sign, amend, check. A signed report is never overwritten."""

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import cast

from msgspec.structs import replace

from .. import __version__
from ..clinical.examination import encode_examination, read_examination
from ..errors import OutputError
from .build import Format, ReportOptions, build_report
from .colours import Palette
from .edition import DRAFT
from .ledger import LEDGER, Version, read_ledger, write_ledger
from .source import EXAMINATION, file_hash, read_source, source_hashes

_READ_ONLY = 0o444


@dataclass(frozen=True, kw_only=True)
class ReportFolders:
    """Where results lie and where their report is kept; often the same."""

    results: Path
    report: Path


def write_preview(directory: Path) -> Path:
    """Write `report.html` of a result folder, a draft that no ledger knows; returns its path.

    Raises:
        OutputError: result.json is absent or broken, or the page cannot be written.
    """
    path = directory / "report.html"
    made = build_report(read_source(directory), ReportOptions(formats=("html",)), DRAFT)
    _write(path, made["html"])
    return path


def draft_report(folders: ReportFolders, options: ReportOptions, examination: Path | None = None) -> tuple[Path, ...]:
    """Make the draft, or make it anew; returns its files.

    Args:
        folders: Where the results lie and where the report goes.
        options: What to show and how.
        examination: File of the clinical examination; it is kept beside the report.

    Raises:
        OutputError: The last version is signed, or nothing can be written.
        InvalidSubject: The examination cannot be read.
    """
    ledger = read_ledger(folders.report)
    last = ledger.last
    if last is not None and last.state != "draft":
        raise OutputError(
            f"version {last.number} is signed by {last.signed_by} and is not overwritten; "
            "'gaitlab report amend' opens the next version"
        )
    if examination is not None:
        _write(folders.report / EXAMINATION, encode_examination(read_examination(examination)))
    edition = DRAFT if last is None else last.edition
    source = read_source(folders.results, folders.report)
    made = build_report(source, options, edition)
    paths = {folders.report / f"report.{ending}": content for ending, content in made.items()}
    for path, content in paths.items():
        _write(path, content)
    _remove([folders.report / name for name in (last.files if last else {}) if folders.report / name not in paths])
    version = Version(
        number=edition.number,
        state="draft",
        made_at=_now(),
        gaitlab=__version__,
        files=_hashes(paths),
        sources=dict(source.hashes),
        pages=list(options.pages),
        colours=options.colours,
        amended_by=edition.amended_by,
        reason=edition.reason,
    )
    write_ledger(ledger.with_last(version), folders.report)
    return tuple(paths)


def sign_report(folders: ReportFolders, by: str) -> tuple[Path, ...]:
    """Sign the draft as it was read: its files are made anew with the signature, and kept for good.

    Raises:
        OutputError: There is no draft, or it or its results have changed since it was made.
    """
    ledger = read_ledger(folders.report)
    draft = ledger.last
    if not by.strip():
        raise OutputError("a report is signed by somebody: give --by NAME")
    if draft is None or draft.state != "draft":
        raise OutputError("there is no draft to sign; 'gaitlab report DIR' makes one, 'gaitlab report amend' the next")
    changed = _changed(draft, folders)
    if changed:
        raise OutputError(f"{', '.join(changed)} changed since the draft was made: make and read the draft anew")
    signed = replace(draft, state="signed", signed_by=by.strip(), signed_at=_now())
    options = ReportOptions(
        formats=tuple(cast("Format", Path(name).suffix[1:]) for name in draft.files),
        pages=tuple(draft.pages),
        colours=cast("Palette", draft.colours),
    )
    made = build_report(read_source(folders.results, folders.report), options, signed.edition)
    paths = {folders.report / f"report-v{draft.number}.{ending}": content for ending, content in made.items()}
    for path, content in paths.items():
        _write_once(path, content)
    before = [replace(entry, state="amended") for entry in ledger.versions[:-1]]
    new = replace(ledger, versions=[*before, replace(signed, files=_hashes(paths))])
    write_ledger(new, folders.report)
    _remove([folders.report / name for name in draft.files])
    return tuple(paths)


def amend_report(folders: ReportFolders, by: str, reason: str, examination: Path | None = None) -> tuple[Path, ...]:
    """Open the next version of a signed report as a draft that says who amends it and why; returns its files.

    Raises:
        OutputError: The last version is not signed, or nobody or no reason is given.
    """
    ledger = read_ledger(folders.report)
    signed = ledger.last
    if signed is None or signed.state == "draft":
        raise OutputError("there is no signed report to amend; a draft is made anew with 'gaitlab report DIR'")
    if not by.strip() or not reason.strip():
        raise OutputError("an amendment has an author and a reason: give --by NAME and --reason TEXT")
    opened = Version(
        number=signed.number + 1,
        state="draft",
        made_at=_now(),
        gaitlab=__version__,
        files={},
        sources={},
        pages=signed.pages,
        colours=signed.colours,
        amended_by=by.strip(),
        reason=reason.strip(),
    )
    write_ledger(ledger.with_last(opened), folders.report)
    options = ReportOptions(pages=tuple(signed.pages), colours=cast("Palette", signed.colours))
    return draft_report(folders, options, examination)


def problems_of(folders: ReportFolders) -> tuple[str, ...]:
    """What no longer agrees with the ledger: files of signed versions, results of the newest version."""
    ledger = read_ledger(folders.report)
    if ledger.last is None:
        raise OutputError(f"{folders.report} holds no {LEDGER}; 'gaitlab report DIR' makes a report")
    found = [
        f"version {version.number}: {name} is not what it was"
        for version in ledger.versions
        for name in _different(version.files, _present(version.files, folders.report))
    ]
    return (*found, *(f"{name} changed since version {ledger.last.number}" for name in _stale(ledger.last, folders)))


def _changed(version: Version, folders: ReportFolders) -> list[str]:
    return [*_different(version.files, _present(version.files, folders.report)), *_stale(version, folders)]


def _stale(version: Version, folders: ReportFolders) -> list[str]:
    return _different(version.sources, source_hashes(folders.results, folders.report))


def _different(then: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    return sorted(name for name in {*then, *now} if then.get(name) != now.get(name))


def _present(names: Mapping[str, str], folder: Path) -> dict[str, str]:
    return {name: file_hash(folder / name) for name in names if (folder / name).is_file()}


def _hashes(paths: Mapping[Path, bytes]) -> dict[str, str]:
    return {path.name: hashlib.sha256(content).hexdigest() for path, content in paths.items()}


def _now() -> str:
    return datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")


def _write(path: Path, content: bytes) -> None:
    try:
        path.write_bytes(content)
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def _write_once(path: Path, content: bytes) -> None:
    try:
        with path.open("xb") as file:
            file.write(content)
        os.chmod(path, _READ_ONLY)
    except FileExistsError as error:
        raise OutputError(f"{path} exists, and no signed report is overwritten: move it away") from error
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def _remove(paths: list[Path]) -> None:
    for path in paths:
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise OutputError(f"{path} cannot be removed ({error.strerror})") from error
