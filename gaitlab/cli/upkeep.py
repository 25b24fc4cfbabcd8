"""What an operator does by hand besides backups: retention, and everything about one patient as a zip."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from uuid import UUID

import typer
from rich.console import Console
from rich.table import Table
from sqlalchemy import or_, select

from ..errors import InvalidRequest, NotFound, OutputError
from ..storage.audit import SYSTEM, Deed, record
from ..storage.database import Database
from ..storage.export import export_patient
from ..storage.files import open_store
from ..storage.models import Patient
from ..storage.retention import apply_retention, change_rule, rules
from .given_settings import settings_of
from .service import opened, running_database

DEFAULT = "default"


def retention(given: Mapping[str, Any], keep: Sequence[str], now: bool) -> None:
    """`gaitlab retention`: change rules, apply them, show them."""
    settings = settings_of(given)
    wanted = dict(map(_rule, keep))
    with running_database(settings) as (url, _), opened(url) as database:
        with database.transaction() as session:
            for subject, days in wanted.items():
                change_rule(session, subject, days, SYSTEM)
            kept = rules(session)
        if now:
            applied = apply_retention(database, open_store(settings))
            removed = ", ".join(f"{count} {subject}" for subject, count in sorted(applied.removed.items()) if count)
            typer.echo(f"removed: {removed or 'no rows'}; {applied.files} files")
    table = Table("what", "days kept", title="Retention")
    for subject, days in kept.items():
        table.add_row(subject, "for ever" if days is None else str(days))
    Console().print(table)


def _rule(text: str) -> tuple[str, int | None]:
    subject, _, days = text.partition("=")
    if days == DEFAULT:
        return subject, None
    if not (days.isascii() and days.isdigit() and int(days) > 0):
        raise InvalidRequest(f"{text!r} is no rule: write SUBJECT=DAYS, such as patients=3650, or SUBJECT={DEFAULT}")
    return subject, int(days)


def write_patient(given: Mapping[str, Any], patient: str, target: Path) -> None:
    """`gaitlab export-patient`."""
    settings = settings_of(given)
    if target.exists():
        raise OutputError(f"{target} exists: choose another name")
    with running_database(settings) as (url, _), opened(url) as database:
        patient_id = _noted(database, patient)
        part = target.with_name(f".{target.name}.part")
        try:
            with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as file:
                export_patient(database, open_store(settings), patient_id, file)
            part.replace(target)
        except OSError as error:
            raise OutputError(f"{target} cannot be written ({error.strerror})") from error
        finally:
            part.unlink(missing_ok=True)
    typer.echo(f"{target}: keep it as you keep the data, it holds the name")


def _noted(database: Database, patient: str) -> UUID:
    """Identifier of a patient, and a line in the audit log that their data leave the installation."""
    try:
        wanted = or_(Patient.id == UUID(patient), Patient.pseudonym == patient)
    except ValueError:
        wanted = Patient.pseudonym == patient
    with database.transaction() as session:
        found = session.scalars(select(Patient.id).where(wanted)).one_or_none()
        if found is None:
            raise NotFound("patient", patient, ())
        record(session, SYSTEM, Deed(action="export", kind="patients", object_id=str(found), patient_id=found))
    return found
