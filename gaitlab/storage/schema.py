"""What all tables have in common: names of constraints, types of columns, versions of rows."""

from datetime import UTC, datetime
from enum import StrEnum
from typing import Annotated, Any
from uuid import UUID, uuid4

from sqlalchemy import CHAR, BigInteger, DateTime, Enum, MetaData, String, func
from sqlalchemy.dialects.postgresql import ARRAY, JSONB
from sqlalchemy.orm import DeclarativeBase, Mapped, MappedAsDataclass, declared_attr, mapped_column

Json = dict[str, Any]
Digest = Annotated[str, mapped_column(CHAR(64))]
"""SHA-256 of a content or a token, in hexadecimal."""
Bytes = Annotated[int, mapped_column(BigInteger)]
"""A size [bytes]."""

NAMES = {
    "ix": "ix_%(column_0_label)s",
    "uq": "uq_%(table_name)s_%(column_0_name)s",
    "ck": "ck_%(table_name)s_%(constraint_name)s",
    "fk": "fk_%(table_name)s_%(column_0_name)s_%(referred_table_name)s",
    "pk": "pk_%(table_name)s",
}
"""Names by rule, so that migrations can refer to constraints."""


def enum_column(kind: type[StrEnum]) -> Enum:
    """Column type of the words of `kind`: text with a check, which a migration can widen."""
    name = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in kind.__name__).lstrip("_")
    return Enum(kind, native_enum=False, create_constraint=True, length=24, name=name, values_callable=_words)


def _words(kind: type[StrEnum]) -> list[str]:
    return [word.value for word in kind]


def now() -> datetime:
    """Present time in UTC."""
    return datetime.now(UTC)


class Row(MappedAsDataclass, DeclarativeBase, kw_only=True, repr=False, eq=False):
    """A row of a table. It has no repr of its own: rows hold names, and logs must not."""

    metadata = MetaData(naming_convention=NAMES)
    type_annotation_map = {
        datetime: DateTime(timezone=True),
        Json: JSONB,
        list[Json]: JSONB,
        list[str]: ARRAY(String),
    }


class Identified(MappedAsDataclass, kw_only=True, repr=False, eq=False):
    """A row with an identifier that cannot be guessed, and the time of its making."""

    id: Mapped[UUID] = mapped_column(primary_key=True, default_factory=uuid4)
    created_at: Mapped[datetime] = mapped_column(server_default=func.now(), default_factory=now, index=True)


class Versioned(MappedAsDataclass, kw_only=True, repr=False, eq=False):
    """A row that two people may edit: an update of an old version is refused (`storage.editing`)."""

    version: Mapped[int] = mapped_column(init=False)

    @declared_attr.directive
    def __mapper_args__(cls) -> dict[str, Any]:
        return {"version_id_col": cls.__table__.c.version}  # type: ignore[attr-defined]
