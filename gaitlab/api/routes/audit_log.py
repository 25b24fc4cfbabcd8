"""Who did what to whose data."""

from typing import Annotated

from fastapi import Query
from sqlalchemy import select

from ...storage.models import AuditEntry
from ..caller import Call
from ..dependencies import allowed
from ..listing import page
from ..permissions import Permission
from ..routing import api_router
from ..schemas.forms import Page
from ..schemas.system import AuditFilter, AuditLine

router = api_router(tag="audit")
Auditor = Annotated[Call, allowed(Permission.AUDIT_READ)]


@router.get("/audit")
def list_audit_lines(call: Auditor, which: Annotated[AuditFilter, Query()]) -> Page[AuditLine]:
    """The audit log, newest first; reading it is noted in it."""
    query = select(AuditEntry)
    for column, value in (
        (AuditEntry.user_id, which.user_id),
        (AuditEntry.patient_id, which.patient_id),
        (AuditEntry.action, which.action or None),
        (AuditEntry.kind, which.kind or None),
    ):
        if value is not None:
            query = query.where(column == value)
    if which.after is not None:
        query = query.where(AuditEntry.at >= which.after)
    if which.before is not None:
        query = query.where(AuditEntry.at < which.before)
    found = page(call, query.order_by(AuditEntry.id.desc()), which, lambda row: AuditLine.model_validate(row[0]))
    call.audit("read", "audit_log", patient_id=which.patient_id)
    return found
