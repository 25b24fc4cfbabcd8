"""For whoever runs the service: is it alive, is it ready, how does it do."""

from http import HTTPStatus
from ipaddress import ip_address
from typing import Any

from fastapi import APIRouter, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest
from sqlalchemy import text
from sqlalchemy.exc import SQLAlchemyError

from ...errors import NotSignedIn
from ..dependencies import services_of
from ..files import content
from ..openapi import operation_id
from ..problems import documented
from ..tokens import same

router = APIRouter(
    tags=["operations"],
    responses=documented(HTTPStatus.UNAUTHORIZED),
    generate_unique_id_function=operation_id,
)
NOT_READY: dict[int | str, dict[str, Any]] = {503: {"description": "Not ready.", "content": {"application/json": {}}}}


@router.get("/health/live")
def get_liveness() -> dict[str, str]:
    """The process answers."""
    return {"status": "live"}


@router.get("/health/ready", responses=NOT_READY)
def get_readiness(request: Request, response: Response) -> dict[str, Any]:
    """The database answers and files can be written."""
    services = services_of(request)
    state = {"database": "ready", "files": "ready"}
    try:
        with services.database.engine.connect() as connection:
            connection.execute(text("SELECT 1"))
    except SQLAlchemyError:
        state["database"] = "away"
    if not services.settings.data_dir.is_dir() or not services.files.answers():
        state["files"] = "away"
    ready = set(state.values()) == {"ready"}
    response.status_code = HTTPStatus.OK if ready else HTTPStatus.SERVICE_UNAVAILABLE
    return {"status": "ready" if ready else "not ready", **state}


@router.get("/metrics", response_class=Response, responses=content("text/plain"))
def get_metrics(request: Request) -> Response:
    """Numbers for Prometheus: for askers with the configured token, or without one for this machine only."""
    services = services_of(request)
    expected = services.settings.metrics_token
    given = request.headers.get("authorization", "").removeprefix("Bearer ")
    if expected is not None:
        admitted = same(given, expected.get_secret_value())
    else:
        admitted = "x-forwarded-for" not in request.headers and _is_local(request)
    if not admitted:
        raise NotSignedIn("metrics need the token of the setting metrics_token")
    numbers = generate_latest(request.app.state.metrics) + generate_latest(services.gauges)
    return Response(numbers, media_type=CONTENT_TYPE_LATEST)


def _is_local(request: Request) -> bool:
    try:
        return request.client is not None and ip_address(request.client.host).is_loopback
    except ValueError:
        return False
