"""Logs as one JSON object a line, with request and job ids, and never a name."""

import logging
import sys
from typing import Any

import structlog

from ..storage.settings import LogFormat

QUIET = ("alembic", "procrastinate", "psycopg", "psycopg.pool", "sqlalchemy", "httpx", "websockets", "asyncio")
"""Their errors only: what they report otherwise is reported by gaitlab, with ids."""


def configure_logs(form: LogFormat) -> None:
    """Send everything, the standard library's loggers included, to stderr through structlog."""
    shared: list[Any] = [
        structlog.contextvars.merge_contextvars,
        structlog.stdlib.add_log_level,
        structlog.stdlib.add_logger_name,
        structlog.processors.TimeStamper(fmt="iso", utc=True),
    ]
    last: Any = structlog.processors.JSONRenderer() if form == "json" else structlog.dev.ConsoleRenderer(colors=False)
    structlog.configure(
        processors=[*shared, structlog.stdlib.ProcessorFormatter.wrap_for_formatter],
        logger_factory=structlog.stdlib.LoggerFactory(),
        wrapper_class=structlog.stdlib.BoundLogger,
        cache_logger_on_first_use=True,
    )
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=shared,
            processors=[
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                structlog.processors.format_exc_info,
                last,
            ],
        )
    )
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel(logging.INFO)
    for name in QUIET:
        logging.getLogger(name).setLevel(logging.ERROR)
    for name in ("uvicorn", "uvicorn.error", "uvicorn.access"):
        logger = logging.getLogger(name)
        logger.handlers, logger.propagate = [], True
    # Addresses of requests may hold what somebody searched for; the access log of gaitlab names routes instead.
    logging.getLogger("uvicorn.access").disabled = True
