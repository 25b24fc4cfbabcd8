"""Errors as problem documents (RFC 9457), with the sentences of the command line."""

import traceback
from collections.abc import Callable, Mapping, Sequence
from http import HTTPStatus
from pathlib import Path
from typing import Any

import structlog
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from sqlalchemy.exc import DataError, IntegrityError, OperationalError, StatementError
from sqlalchemy.exc import TimeoutError as PoolTimeout
from sqlalchemy.orm.exc import StaleDataError
from starlette.exceptions import HTTPException
from starlette.requests import HTTPConnection
from starlette.responses import Response

from ..errors import (
    AccessDenied,
    Conflict,
    GaitlabError,
    NotFound,
    NotSignedIn,
    SecondFactorMissing,
    StorageError,
    TooLarge,
    TooManyAttempts,
)
from ..storage.editing import STALE
from .schemas.forms import Problem

MEDIA_TYPE = "application/problem+json"
LONGEST_INPUT = 80
_STATUS: tuple[tuple[type[GaitlabError], HTTPStatus], ...] = (
    (NotSignedIn, HTTPStatus.UNAUTHORIZED),
    (TooManyAttempts, HTTPStatus.TOO_MANY_REQUESTS),
    (AccessDenied, HTTPStatus.FORBIDDEN),
    (NotFound, HTTPStatus.NOT_FOUND),
    (Conflict, HTTPStatus.CONFLICT),
    (TooLarge, HTTPStatus.REQUEST_ENTITY_TOO_LARGE),
    (StorageError, HTTPStatus.SERVICE_UNAVAILABLE),
    (GaitlabError, HTTPStatus.UNPROCESSABLE_ENTITY),
)
"""First fit counts: special before general. Bad recordings, subjects and references are content that does not fit."""
log = structlog.stdlib.get_logger()


class Absent(NotFound):
    """An object does not exist, or is hidden from the caller: which of both, a stranger must not learn."""

    def __init__(self, kind: str, name: object) -> None:
        GaitlabError.__init__(self, f"{kind} '{name}' does not exist, or is not shared with you")


def status_of(error: GaitlabError) -> HTTPStatus:
    """HTTP status of one of our errors."""
    return next(status for kind, status in _STATUS if isinstance(error, kind))


def problem(
    request: HTTPConnection,
    status: HTTPStatus,
    detail: str,
    errors: Sequence[Mapping[str, str]] | None = None,
    headers: Mapping[str, str] | None = None,
    **members: Any,
) -> Response:
    """A problem document."""
    words = str(members.pop("words", status.phrase)).lower().replace(" ", "-")
    document = Problem(
        type=f"urn:gaitlab:{words}",
        title=status.phrase,
        status=status,
        detail=detail,
        instance=request.url.path,
        request_id=str(request.scope.get("state", {}).get("request_id", "")),
        errors=None if errors is None else [dict(each) for each in errors],
        **members,
    )
    text = document.model_dump_json(exclude_none=True)
    return Response(text, status, dict(headers or {}), media_type=MEDIA_TYPE)


def as_response(request: HTTPConnection, error: GaitlabError) -> Response:
    """One of our errors as a problem document."""
    status, members, headers = status_of(error), dict[str, Any](), dict[str, str]()
    if isinstance(error, Conflict) and error.current is not None:
        members["current_version"] = error.current
        headers["ETag"] = f'"{error.current}"'
    if isinstance(error, TooManyAttempts):
        members["retry_after"] = error.seconds
        headers["Retry-After"] = str(max(1, round(error.seconds)))
    if isinstance(error, SecondFactorMissing):
        members["words"] = "second factor missing"
    if isinstance(error, NotSignedIn):
        headers["WWW-Authenticate"] = "Bearer"
    return problem(request, status, str(error), headers=headers, **members)


def _ours(request: Request, error: Exception) -> Response:
    assert isinstance(error, GaitlabError)
    return as_response(request, error)


def _malformed(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    errors = [_field(each) for each in error.errors()]
    first = errors[0] if errors else {"where": "request", "why": "malformed"}
    return problem(request, HTTPStatus.UNPROCESSABLE_ENTITY, f"{first['where']}: {first['why']}", errors=errors[:50])


def _field(error: Mapping[str, Any]) -> dict[str, str]:
    """Where and why; the value itself is not repeated, because it may be a password or a name."""
    where = ".".join(str(part) for part in error.get("loc", ()))
    return {"where": where[:LONGEST_INPUT], "why": str(error.get("msg", "")).removeprefix("Value error, ")}


def _from_framework(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    status = HTTPStatus(error.status_code)
    return problem(request, status, str(error.detail), headers=error.headers)


def _unstorable(request: Request, error: Exception) -> Response:
    del error  # Its text holds values.
    sentence = "a value cannot be stored: a number or a date is out of range, or a text holds forbidden characters"
    return problem(request, HTTPStatus.UNPROCESSABLE_ENTITY, sentence)


def _stale(request: Request, error: Exception) -> Response:
    del error  # Says nothing that a user understands.
    return problem(request, HTTPStatus.CONFLICT, STALE)


def _clash(request: Request, error: Exception) -> Response:
    assert isinstance(error, IntegrityError)
    diagnosis = getattr(error.orig, "diag", None)
    name = str(getattr(diagnosis, "constraint_name", "") or "")
    if name.startswith("uq_"):
        sentence = f"there is already one with this {name.rsplit('_', 1)[-1]}: choose another"
    else:
        sentence = "something else refers to it, or it refers to something that was deleted meanwhile"
    return problem(request, HTTPStatus.CONFLICT, sentence)


def _no_database(request: Request, error: Exception) -> Response:
    log.error("database not reachable", reason=type(error).__name__)
    sentence = "the database cannot be reached at the moment: try again"
    return problem(request, HTTPStatus.SERVICE_UNAVAILABLE, sentence, headers={"Retry-After": "2"})


def _fault(request: Request, error: Exception) -> Response:
    # Where it happened, but not the error's text, which may hold values.
    places = [f"{Path(frame.filename).name}:{frame.lineno}" for frame in traceback.extract_tb(error.__traceback__)]
    log.error("fault", kind=type(error).__name__, places=places[-6:])
    sentence = "gaitlab made a mistake: give the number of the request to whoever runs the service"
    return problem(request, HTTPStatus.INTERNAL_SERVER_ERROR, sentence)


_HANDLERS: Mapping[type[Exception], Callable[[Request, Exception], Response]] = {
    GaitlabError: _ours,
    RequestValidationError: _malformed,
    HTTPException: _from_framework,
    DataError: _unstorable,
    StatementError: _unstorable,
    IntegrityError: _clash,
    StaleDataError: _stale,
    OperationalError: _no_database,
    PoolTimeout: _no_database,
    Exception: _fault,
}


def add_handlers(app: FastAPI) -> None:
    """Make every error that an endpoint raises a problem document."""
    for kind, handler in _HANDLERS.items():
        app.add_exception_handler(kind, handler)


def documented(*statuses: HTTPStatus) -> dict[int | str, dict[str, Any]]:
    """Entry of the OpenAPI document for errors that routes may answer with."""
    return {
        int(status): {"description": status.phrase, "content": {MEDIA_TYPE: {"schema": _REFERENCE}}}
        for status in statuses
    }


_REFERENCE = {"$ref": "#/components/schemas/Problem"}
