"""How routes are declared: each router knows its whole paths, so that the application holds one flat list of them.

Routers inside routers are matched router by router, for a quarter of the processor time of a small answer.
"""

from collections.abc import Callable, Coroutine, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from starlette.concurrency import run_in_threadpool

from .dependencies import asker_of
from .openapi import operation_id, permission_of
from .problems import documented
from .turns import in_one_turn

PREFIX = "/api/v1"
S = HTTPStatus
PROBLEMS = documented(
    S.BAD_REQUEST, S.UNAUTHORIZED, S.FORBIDDEN, S.NOT_FOUND, S.CONFLICT, S.REQUEST_ENTITY_TOO_LARGE,
    S.UNPROCESSABLE_ENTITY, S.TOO_MANY_REQUESTS, S.SERVICE_UNAVAILABLE,
)  # fmt: skip


class Route(APIRoute):
    """A route whose endpoint does its work in one turn."""

    def __init__(self, path: str, endpoint: Callable[..., Any], *, status_code: int | None = None, **more: Any) -> None:
        super().__init__(path, in_one_turn(endpoint, status_code), status_code=status_code, **more)

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Answer requests; only those who may ask learn what is wrong with a malformed one."""
        handle, permission = super().get_route_handler(), permission_of(self)

        async def checked(request: Request) -> Response:
            try:
                return await handle(request)
            except RequestValidationError:
                if permission is not None:
                    await run_in_threadpool(asker_of, request, permission)
                raise

        return checked


def api_router(prefix: str = "", tag: str | None = None) -> APIRouter:
    """Router for paths below `/api/v1` and a prefix such as "/patients"."""
    return APIRouter(
        prefix=PREFIX + prefix,
        tags=None if tag is None else [tag],
        responses=PROBLEMS,
        generate_unique_id_function=operation_id,
        route_class=Route,
    )


def add_routes(app: FastAPI, routers: Sequence[APIRouter]) -> None:
    """Add the routes of routers as they are; those that come first are found first."""
    for router in routers:
        app.router.routes.extend(router.routes)
