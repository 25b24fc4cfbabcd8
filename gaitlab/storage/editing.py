"""Changes of rows that two people may edit at the same time."""

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from typing import Any

from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session
from sqlalchemy.orm.exc import StaleDataError

from ..errors import Conflict
from .schema import Row, Versioned

STALE = "somebody changed this meanwhile: load it again and repeat the change"


def check_version(row: Versioned, version: int) -> None:
    """Refuse a change that was made to another version than the present one.

    Raises:
        Conflict: With the present version.
    """
    if row.version != version:
        raise Conflict(STALE, row.version)


def assign(row: Row, values: Mapping[str, Any], clearable: frozenset[str] = frozenset()) -> None:
    """Give the columns of a row new values; None means "as it is", but in the columns that may be cleared."""
    for name, value in values.items():
        if value is not None or name in clearable:
            setattr(row, name, value)


@contextmanager
def conflicts(session: Session, taken: str) -> Generator[None]:
    """Flush at the end of the block; what the database refuses becomes a `Conflict`.

    Args:
        session: The session that the changes were made in.
        taken: Sentence for a value that must be unique and is not, or a row that others refer to.
    """
    try:
        yield
        session.flush()
    except StaleDataError as error:
        raise Conflict(STALE) from error
    except IntegrityError as error:
        raise Conflict(taken) from error
