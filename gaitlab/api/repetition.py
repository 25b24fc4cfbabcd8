"""Requests that may be sent twice: the same Idempotency-Key gets the same answer, and the work is done once."""

import hashlib
from collections.abc import Callable
from typing import Annotated, TypeVar
from uuid import uuid4

from fastapi import Header
from pydantic import BaseModel
from sqlalchemy import select
from sqlalchemy.dialects.postgresql import insert

from ..errors import InvalidRequest
from ..storage.models import IdempotencyKey
from .caller import Call

M = TypeVar("M", bound=BaseModel)
RepetitionKey = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        min_length=1,
        max_length=200,
        pattern=r"^[\x21-\x7e]+$",
        description="Any text of one's own choice; a request repeated with it is answered as the first time.",
        examples=["7d1c4c1e-upload-42"],
    ),
]


def once(
    call: Call, key: str | None, request: tuple[str, BaseModel | None], answer: type[M], make: Callable[[], M]
) -> M:
    """Answer of `make`, or the stored answer to the same request.

    Args:
        call: The request; key and answer belong to its transaction, so that a failed request leaves no key behind.
        key: The caller's key; None: always do the work.
        request: Name of the operation and its body.
        answer: Type of the answer.
        make: Does the work.

    Raises:
        InvalidRequest: The key was used for another request.
    """
    if key is None:
        return make()
    operation, body = request
    text = f"{operation}\n{'' if body is None else body.model_dump_json()}"
    digest = hashlib.sha256(text.encode()).hexdigest()
    values = {"id": uuid4(), "user_id": call.caller.user_id, "key": key, "request_hash": digest}
    # A second request waits here until the first has ended.
    claim = insert(IdempotencyKey).values(**values, headers={}, body=b"").on_conflict_do_nothing()
    claimed = call.db.execute(claim.returning(IdempotencyKey.id)).scalar_one_or_none()
    query = select(IdempotencyKey).where(IdempotencyKey.user_id == call.caller.user_id, IdempotencyKey.key == key)
    row = call.db.scalars(query).one()
    if claimed is None:
        if row.request_hash != digest:
            raise InvalidRequest(f"the Idempotency-Key {key!r} was used for another request: choose a new one")
        return answer.model_validate_json(row.body)
    made = make()
    row.status, row.body = 201, made.model_dump_json().encode()
    return made
