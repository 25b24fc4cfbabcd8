"""What endpoints ask for: the caller with a permission, versions for optimistic locking, keys for repeated requests."""

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Depends, Header, Request, Response
from sqlalchemy.orm import Session
from starlette.requests import HTTPConnection

from ..errors import AccessDenied, InvalidRequest
from ..storage import editing
from ..storage.audit import Deed, record
from ..storage.schema import Versioned
from .authentication import Credentials, find_caller
from .caller import Call, Caller, Origin
from .origin import SAFE
from .permissions import Permission
from .services import Services

COOKIE = "gaitlab_session"
SECURE_COOKIE = f"__Host-{COOKIE}"
"""Browsers take this name only over TLS and only for our own host."""


def services_of(request: HTTPConnection) -> Services:
    """The services of the running application."""
    return request.app.state.services


def origin_of(request: HTTPConnection) -> Origin:
    """Address and number of the request."""
    address = request.client.host if request.client is not None else ""
    return Origin(address=address, request_id=str(getattr(request.state, "request_id", "")))


def transaction(request: Request) -> Generator[Session]:
    """The request's transaction: committed before the answer is sent, undone by an error."""
    with services_of(request).database.transaction() as session:
        yield session


Transaction = Annotated[Session, Depends(transaction, scope="function")]


def credentials_of(request: HTTPConnection) -> Credentials:
    """What the request brings along to say who asks."""
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    return Credentials(
        cookie=request.cookies.get(SECURE_COOKIE) or request.cookies.get(COOKIE, ""),
        bearer=token.strip() if scheme.lower() == "bearer" else "",
        csrf=request.headers.get("x-csrf-token", ""),
        changes=request.scope.get("method", "GET") not in SAFE,
    )


def caller_of(db: Session, request: HTTPConnection, permission: Permission) -> Caller:
    """The caller, who must hold the permission; a refusal is audited.

    Raises:
        AccessDenied: Not signed in, or without the permission.
    """
    caller = find_caller(db, credentials_of(request), services_of(request).settings)
    if permission not in caller.permissions:
        refuse(request, caller, permission)
    return caller


def refuse(request: HTTPConnection, caller: Caller, permission: Permission) -> None:
    """Write an audit line that outlives the undone transaction, and raise AccessDenied."""
    deed = Deed(action="denied", kind="requests", object_id=request.url.path, detail={"permission": str(permission)})
    with services_of(request).database.transaction() as db:
        record(db, origin_of(request).actor(caller), deed)
    through = "token" if caller.token_id is not None else f"role {caller.role}"
    raise AccessDenied(f"your {through} does not allow this ({permission})")


@dataclass(frozen=True, kw_only=True)
class Asking:
    """A request whose caller is looked up where its work is done, in the same thread and transaction."""

    request: Request
    permission: Permission

    @contextmanager
    def begin(self) -> Generator[Call]:
        """The call of somebody who holds the permission, committed at the end of the block."""
        services = services_of(self.request)
        with services.database.transaction() as db:
            caller = caller_of(db, self.request, self.permission)
            yield Call(db=db, caller=caller, origin=origin_of(self.request), services=services)


def allowed(permission: Permission) -> Any:
    """Dependency: the call of somebody who holds `permission`; `turns.in_one_turn` begins it."""

    # Asynchronous, or the framework would hand it to another thread.
    async def asking(request: Request) -> Asking:
        return Asking(request=request, permission=permission)

    asking.__dict__["permission"] = permission
    return Depends(asking)


@dataclass(frozen=True, kw_only=True)
class Asker:
    """A caller whose request takes long, so that it holds no transaction meanwhile."""

    caller: Caller
    origin: Origin
    services: Services

    @contextmanager
    def begin(self) -> Generator[Call]:
        """A transaction of the caller's, committed at the end of the block."""
        with self.services.database.transaction() as db:
            yield Call(db=db, caller=self.caller, origin=self.origin, services=self.services)


def asker_of(connection: HTTPConnection, permission: Permission) -> Asker:
    """Who asks over a connection; raises AccessDenied without the permission."""
    services = services_of(connection)
    with services.database.transaction() as db:
        caller = caller_of(db, connection, permission)
    return Asker(caller=caller, origin=origin_of(connection), services=services)


def allowed_slowly(permission: Permission) -> Any:
    """Dependency: somebody who holds `permission`, for uploads and streams."""

    def asker(request: Request) -> Asker:
        return asker_of(request, permission)

    asker.__dict__["permission"] = permission
    return Depends(asker)


async def _version(
    if_match: Annotated[
        str | None, Header(description="Version that was read, as in its ETag.", examples=['"1"'])
    ] = None,
) -> int | None:
    if if_match is None or if_match.strip() == "*":
        return None
    text = if_match.strip().removeprefix("W/").strip('"')
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise InvalidRequest(f'If-Match is {if_match[:40]!r}: send the ETag of what was read, such as "3"')
    return int(text)


ExpectedVersion = Annotated[int | None, Depends(_version)]
"""Version that the caller has read; None: any."""


def check_version(row: Versioned, expected: int | None) -> None:
    """Raise Conflict when somebody else changed the object after the caller read it."""
    if expected is not None:
        editing.check_version(row, expected)


def tag(response: Response, version: int) -> None:
    """Say the version of the answer."""
    response.headers["ETag"] = f'"{version}"'
