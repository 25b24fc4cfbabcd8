"""The log of who did what to whose data."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from uuid import UUID

from sqlalchemy import insert
from sqlalchemy.orm import Session

from .models import AuditEntry
from .schema import now


@dataclass(frozen=True, kw_only=True)
class Actor:
    """Who acts: a signed-in user, or the installation itself."""

    user_id: UUID | None = None
    login: str = ""
    request_id: str = ""
    address: str = ""


SYSTEM = Actor(login="gaitlab")
"""Retention, backups, commands on the machine."""


@dataclass(frozen=True, kw_only=True)
class Deed:
    """What was done. `detail` holds no names: the log outlives the patient."""

    action: str
    kind: str
    object_id: str = ""
    patient_id: UUID | None = None
    detail: Mapping[str, Any] = field(default_factory=dict[str, Any])


# Every request writes a line: as a plain statement made once, not as an object that the session looks after.
_LINE = insert(AuditEntry.__table__).inline()  # type: ignore[arg-type]


def record(session: Session, actor: Actor, deed: Deed) -> None:
    """Add a line to the log, in the transaction of the deed itself."""
    line = {
        "action": deed.action,
        "kind": deed.kind,
        "at": now(),
        "object_id": deed.object_id,
        "patient_id": deed.patient_id,
        "detail": dict(deed.detail),
        "user_id": actor.user_id,
        "login": actor.login,
        "request_id": actor.request_id,
        "address": actor.address,
    }
    session.execute(_LINE, line)
