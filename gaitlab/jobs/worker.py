"""A worker: fetches jobs from procrastinate's queues, and looks after jobs that others lost."""

import asyncio
import contextlib
import os
import signal
from collections.abc import Awaitable, Callable
from uuid import UUID, uuid4

import structlog
from procrastinate import App, BaseRetryStrategy, PsycopgConnector, RetryDecision
from procrastinate.exceptions import ProcrastinateException
from procrastinate.jobs import Job as QueueJob
from psycopg import OperationalError
from psycopg_pool import PoolTimeout
from sqlalchemy.exc import DBAPIError

from ..errors import StorageError
from ..storage.database import Database
from ..storage.files import FileStore
from ..storage.retention import apply_retention
from ..storage.settings import Settings
from .queue import TASK
from .reconciliation import recover
from .request import QUICK, SOLVE
from .tasks import Runner, TryAgain
from .workspace import workspace

RESTART = 1.0
"""Pause before the queue is opened again after the database was away [s]."""
POLLING = 2.0
"""Longest time between two looks into the queue; new jobs announce themselves at once [s]."""
RETENTION = 24 * 3600.0
log = structlog.stdlib.get_logger()


class _Again(BaseRetryStrategy):
    """Everything that ends with an exception waits again; how often is decided when the job is claimed."""

    def get_retry_decision(self, *, exception: BaseException, job: QueueJob) -> RetryDecision:
        del job  # Unused.
        return RetryDecision(retry_in={"seconds": 0 if isinstance(exception, TryAgain) else 2})


class Worker:
    """Runs until it is told to stop."""

    def __init__(self, settings: Settings, database: Database, store: FileStore) -> None:
        self._settings, self._database, self._store = settings, database, store
        self.name = f"{os.uname().nodename}-{os.getpid()}-{uuid4().hex[:6]}"
        self._parent = settings.data_dir / "work"
        self.runner = Runner(
            database=database, store=store, settings=settings, worker=self.name, workspace=self._parent / self.name
        )
        self._stop = asyncio.Event()

    async def run(self) -> None:
        """Work until SIGTERM or SIGINT; running jobs are then given back to the queue."""
        with workspace(self._parent, self.name):
            await self._run()

    async def _run(self) -> None:
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, self.stop)
        log.info("worker starts", worker=self.name, concurrency=self._settings.concurrency)
        chores = [
            asyncio.create_task(self._repeat(self._settings.heartbeat_seconds, self._recover)),
            asyncio.create_task(self._repeat(RETENTION, self._retain)),
        ]
        try:
            await asyncio.gather(self._serve(QUICK, 1), self._serve(SOLVE, self._settings.concurrency))
        finally:
            for chore in chores:
                chore.cancel()
            await asyncio.gather(*chores, return_exceptions=True)
        log.info("worker stopped", worker=self.name)

    def stop(self) -> None:
        """Stop soon: no new jobs, running ones wait again."""
        self.runner.stopping = True
        self._stop.set()

    async def _serve(self, queue: str, concurrency: int) -> None:
        """Fetch from one queue; open it anew whenever the database comes back."""
        while not self._stop.is_set():
            try:
                await self._fetch(queue, concurrency)
            except (OperationalError, PoolTimeout, ProcrastinateException, DBAPIError) as error:
                log.warning("the queue is away", queue=queue, reason=type(error).__name__)
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(self._stop.wait(), RESTART)

    async def _fetch(self, queue: str, concurrency: int) -> None:
        app = App(connector=PsycopgConnector(conninfo=self._database.url, min_size=1, max_size=3, timeout=10.0))

        @app.task(name=TASK, retry=_Again())
        async def run(job_id: str) -> None:
            await self.runner.run(UUID(job_id))

        async with app.open_async():
            fetching = asyncio.create_task(
                app.run_worker_async(
                    queues=[queue],
                    concurrency=concurrency,
                    name=queue,
                    fetch_job_polling_interval=POLLING,
                    update_heartbeat_interval=self._settings.heartbeat_seconds,
                    stalled_worker_timeout=self._settings.stalled_seconds,
                    delete_jobs="successful",
                    install_signal_handlers=False,
                )
            )
            stopped = asyncio.create_task(self._stop.wait())
            await asyncio.wait({fetching, stopped}, return_when=asyncio.FIRST_COMPLETED)
            stopped.cancel()
            if not fetching.done():
                fetching.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await fetching

    async def _repeat(self, seconds: float, chore: Callable[[], Awaitable[None]]) -> None:
        while True:
            try:
                await chore()
            except (DBAPIError, StorageError) as error:
                log.warning("put off: the database or the files are away", reason=type(error).__name__)
            await asyncio.sleep(seconds)

    async def _recover(self) -> None:
        found = await asyncio.to_thread(recover, self._database, self._settings.stalled_seconds)
        if found.stalled or found.orphans:
            log.info("jobs taken over", stalled=found.stalled, orphans=found.orphans)

    async def _retain(self) -> None:
        applied = await asyncio.to_thread(apply_retention, self._database, self._store)
        log.info("retention applied", files=applied.files, **applied.removed)
