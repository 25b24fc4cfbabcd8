"""`gaitlab worker`: jobs without a web server."""

from collections.abc import Mapping
from typing import Any

from ..jobs.logs import configure_logs
from .given_settings import settings_of
from .service import prepare, running_database
from .worker_process import run_worker


def work(given: Mapping[str, Any]) -> None:
    """`gaitlab worker`."""
    settings = settings_of(given)
    configure_logs(settings.log_format)
    with running_database(settings) as (url, _):
        prepare(settings, url)
        run_worker(settings, url)
