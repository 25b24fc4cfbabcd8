"""Every request gets a number, a line in the log and a place in the metrics; never its query, which may hold names."""

import re
import secrets
import time

import structlog
from prometheus_client import Counter, Gauge, Histogram
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

GIVEN = re.compile(r"^[A-Za-z0-9_-]{8,64}$")
SECONDS = Histogram(
    "gaitlab_request_seconds",
    "Time until the answer began [s]",
    ["method", "route"],
    buckets=(0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 10),
)
REQUESTS = Counter("gaitlab_requests", "Answers", ["method", "route", "status"])
UNDER_WAY = Gauge("gaitlab_requests_under_way", "Requests that are being answered")
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
log = structlog.stdlib.get_logger()


class Observation:
    """Outermost layer of the application."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one connection."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        request_id = _request_id(scope)
        scope.setdefault("state", {})["request_id"] = request_id
        with structlog.contextvars.bound_contextvars(request_id=request_id):
            if scope["type"] == "http":
                await self._observe(scope, receive, send)
            else:
                await self._app(scope, receive, send)

    async def _observe(self, scope: Scope, receive: Receive, send: Send) -> None:
        start, status = time.perf_counter(), 500

        async def noted(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)["x-request-id"] = scope["state"]["request_id"]
                SECONDS.labels(_method(scope), _route(scope)).observe(time.perf_counter() - start)
            await send(message)

        UNDER_WAY.inc()
        try:
            await self._app(scope, receive, noted)
        finally:
            UNDER_WAY.dec()
            REQUESTS.labels(_method(scope), _route(scope), status).inc()
            seconds = round(time.perf_counter() - start, 4)
            log.info("request", method=_method(scope), path=scope["path"], status=status, seconds=seconds)


def _request_id(scope: Scope) -> str:
    given = Headers(scope=scope).get("x-request-id", "")
    return given if GIVEN.match(given) else secrets.token_hex(8)


def _method(scope: Scope) -> str:
    """A label of a metric; callers could invent any number of methods."""
    return scope["method"] if scope["method"] in METHODS else "other"


def _route(scope: Scope) -> str:
    """The route's template: paths hold identifiers, of which there are too many for a metric."""
    return str(getattr(scope.get("route"), "path", "none"))
