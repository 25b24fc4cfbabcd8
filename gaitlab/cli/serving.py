"""`gaitlab serve`: the processes of the web server and the worker, and the database beneath them.

Starting is a race of imports: the web server's process starts before this one loads what the database needs, and the
worker's after, when nobody waits for a page any more.
"""

import signal
import socket
import threading
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from types import FrameType
from typing import Any, Protocol

import structlog
from pydantic import SecretStr

from ..errors import OutputError, StorageError
from ..jobs.logs import configure_logs
from ..storage.settings import Settings
from .children import Child, end_all
from .given_settings import settings_of
from .server_extra import load

WATCH_SECONDS = 0.5
"""Time between two looks at the processes."""
BACKLOG = 512
log = structlog.stdlib.get_logger()


def serve(given: Mapping[str, Any]) -> None:
    """Serve until SIGTERM or SIGINT."""
    settings = settings_of(given)
    configure_logs(settings.log_format)
    stop = _stop_on_signals()
    with _listening(settings) as listener:
        children = [Child("gaitlab.cli.web_process", [listener.fileno()])]
        try:
            _watch(children, None)
            service = load("service")
            with service.running_database(settings) as (url, server):
                service.prepare(settings, url)
                settings = settings.model_copy(update={"database_url": SecretStr(url)})
                if settings.worker:
                    children.append(Child("gaitlab.cli.worker_process"))
                for child in children:
                    child.tell(settings.plain())
                service.tell_address(settings, url, listener.getsockname()[1])
                try:
                    while not stop.is_set():
                        _watch(children, server)
                        stop.wait(WATCH_SECONDS)
                finally:
                    # Before the database goes.
                    end_all(children)
        finally:
            end_all(children)


class _Server(Protocol):
    """An embedded database, whose module is not loaded when this one is."""

    def ensure_running(self) -> bool:
        """Start it again if it died; whether that was needed."""
        ...


def _watch(children: list[Child], server: _Server | None) -> None:
    try:
        if server is not None and server.ensure_running():
            log.warning("the embedded database had died and runs again")
    except StorageError as error:
        log.error("the embedded database does not start", reason=str(error))
    for child in children:
        child.ensure_running()


def _stop_on_signals() -> threading.Event:
    stop = threading.Event()

    def handle(number: int, frame: FrameType | None) -> None:
        del number, frame  # Unused.
        stop.set()

    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, handle)
    return stop


@contextmanager
def _listening(settings: Settings) -> Generator[socket.socket]:
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((settings.host, settings.port))
        except OSError as error:
            raise OutputError(f"{settings.host}:{settings.port} cannot be listened on ({error.strerror})") from error
        listener.listen(BACKLOG)
        yield listener
