"""How long things are kept: rules that an administrator sets, applied by a worker once a day."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any
from uuid import UUID

from sqlalchemy import CursorResult, Delete, delete, func, select
from sqlalchemy.orm import Session

from ..errors import NotFound
from .audit import SYSTEM, Actor, Deed, record
from .database import Database
from .deletion import delete_patient
from .files import FileStore
from .models import (
    GaitSession,
    IdempotencyKey,
    LoginAttempt,
    OneTimeToken,
    Patient,
    RetentionRule,
    Upload,
    UploadChunk,
    UploadState,
    WebSession,
)
from .references import collect_garbage
from .schema import now


@dataclass(frozen=True, kw_only=True)
class Applied:
    """What retention removed, by subject."""

    removed: Mapping[str, int]
    files: int


def _idempotency(before: datetime) -> Delete:
    return delete(IdempotencyKey).where(IdempotencyKey.created_at < before)


def _logins(before: datetime) -> Delete:
    return delete(LoginAttempt).where(LoginAttempt.at < before)


def _web_sessions(before: datetime) -> Delete:
    return delete(WebSession).where(WebSession.expires_at < before)


def _one_time_tokens(before: datetime) -> Delete:
    return delete(OneTimeToken).where(OneTimeToken.expires_at < before)


ROWS: Mapping[str, Callable[[datetime], Delete]] = {
    "idempotency_keys": _idempotency,
    "login_attempts": _logins,
    "web_sessions": _web_sessions,
    "one_time_tokens": _one_time_tokens,
}
DEFAULTS: Mapping[str, int | None] = {
    "patients": None,
    "idempotency_keys": 2,
    "login_attempts": 30,
    "web_sessions": 30,
    "one_time_tokens": 30,
}
"""Days that each subject is kept without a rule of its own; None: for ever. Patients count from their last visit."""
SUBJECTS = tuple(DEFAULTS)


def set_rule(session: Session, subject: str, days: int | None) -> None:
    """Keep a subject for so many days; None: the default again.

    Raises:
        NotFound: There is no such subject.
    """
    if subject not in DEFAULTS:
        raise NotFound("retention subject", subject, SUBJECTS)
    session.execute(delete(RetentionRule).where(RetentionRule.subject == subject))
    if days is not None:
        session.add(RetentionRule(subject=subject, days=days))


def change_rule(session: Session, subject: str, days: int | None, actor: Actor) -> None:
    """As `set_rule`, with a line in the audit log."""
    set_rule(session, subject, days)
    record(session, actor, Deed(action="update", kind="retention_rules", object_id=subject, detail={"days": days}))


def rules(session: Session) -> dict[str, int | None]:
    """Days that each subject is kept."""
    return dict(DEFAULTS) | {rule.subject: rule.days for rule in session.scalars(select(RetentionRule))}


def apply_retention(database: Database, store: FileStore) -> Applied:
    """Remove what is older than its rule, uploads that were given up, and contents that nothing refers to."""
    with database.transaction() as session:
        days = rules(session)
        due = _patients_due(session, days["patients"])
        removed = {subject: _remove(session, subject, days[subject]) for subject in ROWS}
        removed["uploads"] = _abandon_uploads(session)
    for patient_id in due:
        # Another worker may have been faster.
        with suppress(NotFound):
            delete_patient(database, store, patient_id, SYSTEM)
    return Applied(removed=removed | {"patients": len(due)}, files=collect_garbage(database, store))


def _remove(session: Session, subject: str, days: int | None) -> int:
    if days is None:
        return 0
    return _count(session.execute(ROWS[subject](now() - timedelta(days=days))))


def _count(result: Any) -> int:
    return result.rowcount if isinstance(result, CursorResult) else 0


def _patients_due(session: Session, days: int | None) -> list[UUID]:
    today = now().date()
    due = set(session.scalars(select(Patient.id).where(Patient.retain_until < today)))
    if days is not None:
        last = func.coalesce(func.max(GaitSession.visited_on), func.date(Patient.created_at))
        old = (
            select(Patient.id)
            .outerjoin(GaitSession, GaitSession.patient_id == Patient.id)
            .where(Patient.retain_until.is_(None))
            .group_by(Patient.id)
            .having(last < today - timedelta(days=days))
        )
        due |= set(session.scalars(old))
    return sorted(due)


def _abandon_uploads(session: Session) -> int:
    """Forget the chunks of uploads that ran out of time; the contents go with the next collection of garbage."""
    late = list(session.scalars(select(Upload).where(Upload.state == UploadState.OPEN, Upload.expires_at < now())))
    for upload in late:
        upload.state = UploadState.ABANDONED
    session.execute(delete(UploadChunk).where(UploadChunk.upload_id.in_([upload.id for upload in late])))
    return len(late)
