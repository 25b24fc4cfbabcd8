"""The process of a worker: `python -m gaitlab.cli.worker_process`, settings on stdin."""

import asyncio

from prometheus_client import start_http_server

from ..jobs.logs import configure_logs
from ..jobs.worker import Worker
from ..storage.database import Database
from ..storage.files import open_store
from ..storage.settings import Settings
from .children import settings_from_parent


def run_worker(settings: Settings, url: str) -> None:
    """Work until SIGTERM or SIGINT."""
    configure_logs(settings.log_format)
    if settings.metrics_port:
        start_http_server(settings.metrics_port, addr="127.0.0.1")
    database = Database.open(url, connections=2 + settings.concurrency)
    try:
        asyncio.run(Worker(settings, database, open_store(settings)).run())
    finally:
        database.close()


def main() -> None:
    """Work until SIGTERM or the end of the parent."""
    settings = Settings(**settings_from_parent())
    run_worker(settings, "" if settings.database_url is None else settings.database_url.get_secret_value())


if __name__ == "__main__":
    main()
