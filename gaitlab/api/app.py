"""The web application."""

from collections.abc import AsyncGenerator, Callable, Sequence
from contextlib import asynccontextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import anyio.to_thread
from fastapi import FastAPI
from prometheus_client import REGISTRY
from sqlalchemy import select
from starlette.middleware.gzip import GZipMiddleware

from .. import __version__
from ..jobs.events import EventBroker
from ..jobs.metrics import gauges_of
from ..storage.database import Database
from ..storage.files import open_store
from ..storage.models import ApiToken, User, WebSession
from ..storage.sealing import Sealing
from ..storage.settings import Settings
from .authentication import is_alive
from .headers import SecurityHeaders
from .observation import Observation
from .openapi import document
from .origin import OwnPagesOnly
from .pages import FRONTEND, Frontend
from .problems import add_handlers
from .routes import (
    analyses,
    attachments,
    audit_log,
    cohorts,
    operations,
    patients,
    recordings,
    reports,
    results,
    retention,
    sessions,
    sign_in,
    single_sign_on,
    subjects,
    system,
    uploads,
    users,
    viewers,
)
from .routing import PREFIX, add_routes
from .services import Services
from .viewers import Limits, Owner, Viewers

THREADS = 30
"""Requests worked on at a time."""
CONNECTIONS, SPARE = THREADS + 2, 8
"""Of the database: one for each thread and kept open, because new ones in a peak would make it worse; spare ones for
audit lines that outlive an undone transaction."""
UNTRACED: Any = {"tracing": False, "metrics": False, "logs": False}
"""No OpenTelemetry, whatever the environment says: its records would hold what users sent."""
ROUTERS = (
    results.router,
    patients.router,
    sessions.router,
    analyses.router,
    sign_in.router,
    single_sign_on.router,
    users.router,
    recordings.router,
    uploads.router,
    attachments.router,
    subjects.router,
    viewers.router,
    reports.router,
    cohorts.router,
    audit_log.router,
    retention.router,
    system.router,
)


def create_app(settings: Settings, frontend: Path = FRONTEND) -> FastAPI:
    """The application of an installation whose database is there and migrated.

    Args:
        settings: With `database_url`.
        frontend: Folder of the built frontend; without it only the API is served.
    """
    app = FastAPI(
        title="gaitlab",
        version=__version__,
        docs_url=None,
        redoc_url=None,
        openapi_url=f"{PREFIX}/openapi.json",
        lifespan=_lifespan,
        telemetry=UNTRACED,
    )
    app.state.settings, app.state.metrics = settings, REGISTRY
    app.openapi = lambda: document(app, (*ROUTERS, operations.router))
    add_routes(app, (*ROUTERS, operations.router))
    if frontend.is_dir():
        app.mount("/", Frontend(frontend), name="frontend")
    add_handlers(app)
    # The last one added is the outermost.
    # A document of 53 kB at level 1 becomes 13.9 kB in 0.6 ms, at level 5 12.4 kB in 1.5 ms.
    app.add_middleware(GZipMiddleware, minimum_size=1000, compresslevel=1)
    app.add_middleware(OwnPagesOnly)
    app.add_middleware(SecurityHeaders, tls=settings.secure_cookies, uncached=("/api/", "/health/", "/metrics"))
    app.add_middleware(Observation)
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncGenerator[None]:
    settings: Settings = app.state.settings
    url = settings.database_url
    database = Database.open("" if url is None else url.get_secret_value(), CONNECTIONS, SPARE)
    limits = Limits(
        per_user=settings.viewers_per_user, together=settings.viewers, idle=settings.viewer_idle_minutes * 60.0
    )
    services = Services(
        settings=settings,
        database=database,
        files=open_store(settings),
        sealing=Sealing.of(settings),
        events=EventBroker(database.url),
        viewers=Viewers(limits, _signed_out(database, settings)),
        gauges=gauges_of(database),
    )
    app.state.services = services
    anyio.to_thread.current_default_thread_limiter().total_tokens = THREADS
    await services.events.start()
    services.viewers.start()
    try:
        yield
    finally:
        await services.viewers.stop()
        await services.events.stop()
        database.close()


def _signed_out(database: Database, settings: Settings) -> Callable[[Sequence[Owner]], set[Owner]]:
    """Tells which of the owners of 3D sessions have no valid session or token any more."""

    def gone(owners: Sequence[Owner]) -> set[Owner]:
        sessions = [owner.web_session_id for owner in owners if owner.web_session_id is not None]
        tokens = [owner.token_id for owner in owners if owner.token_id is not None]
        moment = datetime.now(UTC)
        with database.sessions() as db:
            found = db.scalars(
                select(WebSession)
                .join(User, User.id == WebSession.user_id)
                .where(WebSession.id.in_(sessions), User.active)
            )
            alive: set[Any] = {session.id for session in found if is_alive(session, moment, settings)}
            valid = select(ApiToken.id).where(ApiToken.id.in_(tokens), ApiToken.revoked_at.is_(None))
            alive |= set(db.scalars(valid))
        return {owner for owner in owners if (owner.web_session_id or owner.token_id) not in alive}

    return gone
