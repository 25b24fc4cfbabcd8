"""What those see who see pseudonyms only: file names of recordings become numbers, wherever they stand in an answer."""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any
from uuid import UUID

from sqlalchemy import select

from ..storage.models import Recording
from .caller import Call


def masked_names(call: Call, sessions: Sequence[UUID]) -> dict[str, str]:
    """Stem of each recording of these visits, and the number that takes its place."""
    query = select(Recording.name, Recording.session_id).where(Recording.session_id.in_(sessions))
    rows = call.db.execute(query.order_by(Recording.session_id, Recording.created_at, Recording.id)).all()
    masks: dict[str, str] = {}
    for name, _ in rows:
        masks.setdefault(Path(name).stem, f"trial-{len(masks) + 1}")
    return masks


def mask(value: Any, masks: Mapping[str, str]) -> Any:
    """A value of JSON with every name in its texts and keys replaced."""
    if not masks:
        return value
    # Not inside longer words: a file called "e.c3d" must not change every e. Longest names first.
    names = "|".join(re.escape(name) for name in sorted(masks, key=len, reverse=True))
    pattern = re.compile(rf"(?<![A-Za-z0-9])(?:{names})(?![A-Za-z0-9])")
    return _replaced(value, pattern, lambda hit: masks[hit[0]])


def _replaced(value: Any, pattern: re.Pattern[str], number: Callable[[re.Match[str]], str]) -> Any:
    if isinstance(value, str):
        return pattern.sub(number, value)
    if isinstance(value, Mapping):
        return {pattern.sub(number, str(key)): _replaced(each, pattern, number) for key, each in value.items()}
    if isinstance(value, Sequence):
        return [_replaced(each, pattern, number) for each in value]
    return value
