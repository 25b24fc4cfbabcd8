"""The OpenAPI document: one source for clients, for the tests of every route, and for readers."""

from collections.abc import Iterator, Sequence
from typing import Any

from fastapi import APIRouter, FastAPI
from fastapi.dependencies.models import Dependant
from fastapi.openapi.utils import get_openapi
from fastapi.routing import APIRoute

from .. import __version__
from .dependencies import COOKIE
from .permissions import Permission
from .schemas.forms import Problem

DESCRIPTION = (
    "Why does this patient walk this way? Every error is a problem document (RFC 9457). Changes of what several people "
    "edit carry If-Match; requests that make something may carry Idempotency-Key and may then be sent twice."
)
SCHEMES = {
    "token": {"type": "http", "scheme": "bearer", "description": "A token made under /tokens."},
    "session": {"type": "apiKey", "in": "cookie", "name": COOKIE, "description": "The session of a browser."},
    "csrf": {"type": "apiKey", "in": "header", "name": "X-CSRF-Token", "description": "With a session, for changes."},
}
SAFE = frozenset({"get", "head"})
REFERENCES = "#/components/schemas/{model}"


def permission_of(route: APIRoute) -> Permission | None:
    """Permission that a route asks for; None: it is open to strangers."""
    return next(_permissions(route.dependant), None)


def _permissions(dependant: Dependant) -> Iterator[Permission]:
    for inner in dependant.dependencies:
        if "permission" in getattr(inner.call, "__dict__", {}):
            yield inner.call.__dict__["permission"]  # type: ignore[union-attr]
        yield from _permissions(inner)


def document(app: FastAPI, routers: Sequence[APIRouter]) -> dict[str, Any]:
    """The OpenAPI document of an application made of these routers."""
    if app.openapi_schema is None:
        made = get_openapi(title="gaitlab", version=__version__, description=DESCRIPTION, routes=app.routes)
        components = made["components"]
        components.setdefault("securitySchemes", {}).update(SCHEMES)
        components["schemas"]["Problem"] = Problem.model_json_schema(ref_template=REFERENCES)
        for unused in ("HTTPValidationError", "ValidationError"):
            components["schemas"].pop(unused, None)
        routes = [route for router in routers for route in router.routes if isinstance(route, APIRoute)]
        permissions = {operation_id(route): permission_of(route) for route in routes}
        for operations in made["paths"].values():
            for method, operation in operations.items():
                _complete(operation, method, permissions[operation["operationId"]])
        app.openapi_schema = made
    return app.openapi_schema


def operation_id(route: APIRoute) -> str:
    """Name of a method in generated clients: that of the endpoint."""
    first, *rest = route.name.split("_")
    return first + "".join(word.capitalize() for word in rest)


def _complete(operation: dict[str, Any], method: str, permission: Permission | None) -> None:
    """Who may call an operation; and our own document for refused values instead of the framework's."""
    if permission is None:
        operation["security"] = []
    else:
        by_cookie = {"session": []} if method in SAFE else {"session": [], "csrf": []}
        operation["security"] = [{"token": []}, by_cookie]
        operation["x-permission"] = str(permission)
    operation["summary"] = str(operation.get("description", "")).partition("\n")[0].rstrip(".")
