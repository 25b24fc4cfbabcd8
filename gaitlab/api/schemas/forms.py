"""What all schemas share: strictness, texts that PostgreSQL can store, pages of lists."""

from collections.abc import Sequence
from datetime import datetime
from typing import Annotated, Generic, TypeVar
from uuid import UUID

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

T = TypeVar("T")
LONGEST_PAGE = 500
FURTHEST = 10_000_000


def _storable(text: str) -> str:
    """PostgreSQL stores no NUL, UTF-8 no half of a surrogate pair."""
    if "\x00" in text or any("\ud800" <= letter <= "\udfff" for letter in text):
        raise ValueError("the text contains characters that cannot be stored (NUL or half a surrogate pair)")
    return text


Storable = AfterValidator(_storable)
Word = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=200), Storable]
"""One line that must say something."""
Line = Annotated[str, StringConstraints(strip_whitespace=True, max_length=200), Storable]
Prose = Annotated[str, StringConstraints(max_length=20_000), Storable]
FileName = Annotated[
    str,
    StringConstraints(min_length=1, max_length=255, pattern=r"^[^/\\\x00-\x1f]+$"),
    Storable,
    Field(examples=["w.c3d"]),
]
"""Without folders: a path of someone else's machine is neither needed nor kept."""
Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
Password = Annotated[str, StringConstraints(min_length=1, max_length=256), Storable]


class Input(BaseModel):
    """A request; what we do not know is refused, because a misspelt field would be lost silently."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Output(BaseModel):
    """An answer, read from rows or values."""

    model_config = ConfigDict(from_attributes=True, frozen=True)


class Page(Output, Generic[T]):
    """A part of a list, with the length of the whole."""

    items: Sequence[T]
    total: int = Field(description="Length of the whole list.", examples=[1])
    limit: int = Field(examples=[50])
    offset: int = Field(examples=[0])


class Paging(Input):
    """Which part of a list."""

    limit: int = Field(default=50, ge=1, le=LONGEST_PAGE, description="At most so many.")
    offset: int = Field(default=0, ge=0, le=FURTHEST, description="After so many.")


class Stored(Output):
    """What every stored object says of itself."""

    id: UUID = Field(examples=["5f8c2a5e-3b9d-4f7e-9a54-0d8f6f3a1c22"])
    created_at: datetime = Field(examples=["2026-11-22T09:30:00Z"])


class Edited(Stored):
    """An object that several people may edit."""

    version: int = Field(description="Grows with every change; send it back as If-Match.", examples=[1])


class Problem(BaseModel):
    """An error (RFC 9457)."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "type": "urn:gaitlab:not-found",
                    "title": "Not found",
                    "status": 404,
                    "detail": "patient '5f8c2a5e' does not exist, or is not shared with you",
                    "instance": "/api/v1/patients/5f8c2a5e",
                    "request_id": "b1946ac92492d234",
                }
            ]
        }
    )
    type: str
    title: str
    status: int
    detail: str = Field(description="One sentence: what was wrong, what was expected, what exists.")
    instance: str
    request_id: str
    errors: list[dict[str, str]] | None = Field(default=None, description="Per field of the request: where and why.")
    current_version: int | None = Field(default=None, description="With 409: the version that is stored now.")
    retry_after: float | None = Field(default=None, description="With 429: seconds to wait.")
