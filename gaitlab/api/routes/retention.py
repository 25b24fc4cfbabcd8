"""How long things are kept, for administrators; a worker removes once a day what is too old."""

from typing import Annotated

from sqlalchemy.orm import Session

from ...storage.retention import change_rule, rules
from ..caller import Call
from ..dependencies import allowed
from ..permissions import Permission
from ..routing import api_router
from ..schemas.system import RetentionChange, RetentionRule

router = api_router("/retention", tag="system")
Reader = Annotated[Call, allowed(Permission.SYSTEM_READ)]
Manager = Annotated[Call, allowed(Permission.SYSTEM_WRITE)]


def _all(db: Session) -> list[RetentionRule]:
    return [RetentionRule(subject=subject, days=days) for subject, days in rules(db).items()]


@router.get("")
def list_retention_rules(call: Reader) -> list[RetentionRule]:
    """Every subject and how long it is kept."""
    return _all(call.db)


@router.put("/{subject}")
def set_retention_rule(call: Manager, subject: str, body: RetentionChange) -> RetentionRule:
    """Keep a subject for so many days; null: the default again."""
    change_rule(call.db, subject, body.days, call.actor)
    call.db.flush()
    return next(rule for rule in _all(call.db) if rule.subject == subject)
