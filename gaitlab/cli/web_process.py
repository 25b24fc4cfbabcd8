"""The process of the web server: `python -m gaitlab.cli.web_process DESCRIPTOR`, a listening socket of its parent.

The parent keeps the socket: while this process is started again, requests wait instead of failing.
"""

import gc
import socket
import sys

import uvicorn

from ..api.app import create_app
from ..jobs.logs import configure_logs
from ..storage.settings import Settings
from .children import settings_from_parent

SHUTDOWN_SECONDS = 10
KEEP_ALIVE_SECONDS = 75
"""Longer than proxies keep idle connections, or one of them would send a request into a connection that just closes."""


def spare_what_stays() -> None:
    """Take what was loaded out of Python's search for garbage: to look through it all again makes requests wait."""
    gc.collect()
    gc.freeze()


def main() -> None:
    """Serve until SIGTERM or the end of the parent."""
    settings = Settings(**settings_from_parent())
    configure_logs(settings.log_format)
    app = create_app(settings)
    spare_what_stays()
    config = uvicorn.Config(
        app,
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=bool(settings.trusted_proxies),
        forwarded_allow_ips=list(settings.trusted_proxies),
        ssl_certfile=settings.tls_certificate,
        ssl_keyfile=settings.tls_key,
        timeout_graceful_shutdown=SHUTDOWN_SECONDS,
        timeout_keep_alive=KEEP_ALIVE_SECONDS,
    )
    uvicorn.Server(config).run([socket.socket(fileno=int(sys.argv[1]))])


if __name__ == "__main__":
    main()
