"""Whether a request was made by one of our own pages: browsers say so, and cannot be made to lie by other sites."""

from urllib.parse import urlsplit

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from ..errors import AccessDenied
from .problems import as_response

SAFE = frozenset({"GET", "HEAD", "OPTIONS"})


def is_same_origin(connection: HTTPConnection) -> bool:
    """True without an Origin header, which only browsers send, and for the host that was asked."""
    origin = connection.headers.get("origin")
    return origin is None or urlsplit(origin).netloc.lower() == connection.headers.get("host", "").lower()


class OwnPagesOnly:
    """Refuses changes that pages of other sites ask for."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one connection."""
        if scope["type"] == "http" and scope["method"] not in SAFE:
            connection = HTTPConnection(scope)
            if not is_same_origin(connection):
                error = AccessDenied("the request comes from a page of another site, so it is refused")
                await as_response(connection, error)(scope, receive, send)
                return
        await self._app(scope, receive, send)
