"""Parts of long lists."""

from collections.abc import Callable
from typing import Any, TypeVar

from pydantic import BaseModel
from sqlalchemy import Select, func, select

from .caller import Call
from .schemas.forms import Page, Paging

M = TypeVar("M", bound=BaseModel)


def page(call: Call, query: Select[*tuple[Any, ...]], paging: Paging, model: Callable[[Any], M]) -> Page[M]:
    """One part of a query that is ordered, made into answers by `model`."""
    rows = call.db.execute(query.limit(paging.limit).offset(paging.offset)).all()
    total = paging.offset + len(rows)
    if len(rows) == paging.limit or (paging.offset and not rows):
        # More may follow, or the part lies behind the end: only then do they have to be counted.
        total = call.db.scalar(select(func.count()).select_from(query.order_by(None).subquery())) or 0
    return Page[M](items=[model(row) for row in rows], total=total, limit=paging.limit, offset=paging.offset)


def containing(text: str) -> str:
    """Pattern of LIKE for texts that contain `text`."""
    escaped = text.replace("\\", "\\\\").replace("%", "\\%").replace("_", "\\_")
    return f"%{escaped}%"
