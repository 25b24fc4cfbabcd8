"""Parts of long lists."""

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeVar

from pydantic import BaseModel
from sqlalchemy import Integer, Select, bindparam, func, select

from .caller import Call
from .schemas.forms import Page, Paging

M = TypeVar("M", bound=BaseModel)
_LIMIT, _OFFSET = (bindparam(name, type_=Integer()) for name in ("part_limit", "part_offset"))


class Listing:
    """A query that is ordered; the statements for its parts are made once, so keep it if it is asked often."""

    def __init__(self, query: Select[*tuple[Any, ...]]) -> None:
        self._query, self.part = query, query.limit(_LIMIT).offset(_OFFSET)

    @cached_property
    def count(self) -> Select[Any]:
        """Length of the whole list."""
        return select(func.count()).select_from(self._query.order_by(None).subquery())


def page(
    call: Call, rows: Listing | Select[*tuple[Any, ...]], paging: Paging, model: Callable[[Any], M], **values: Any
) -> Page[M]:
    """One part of a list, made into answers by `model`; `values` are those of the parameters of its query."""
    listing = rows if isinstance(rows, Listing) else Listing(rows)
    found = call.find(listing.part, part_limit=paging.limit, part_offset=paging.offset, **values).all()
    total = paging.offset + len(found)
    if len(found) == paging.limit or (paging.offset and not found):
        # More may follow, or the part lies behind the end: only then do they have to be counted.
        total = call.find(listing.count, **values).scalar_one()
    return Page[M](items=[model(row) for row in found], total=total, limit=paging.limit, offset=paging.offset)


def containing(text: str) -> str:
    """Pattern of LIKE for texts that contain `text`."""
    escaped = text.replace("\\", "\\\\").replace("%", "\\%").replace("_", "\\_")
    return f"%{escaped}%"
