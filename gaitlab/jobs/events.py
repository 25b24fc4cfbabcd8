"""News of jobs from worker to browser, by PostgreSQL's NOTIFY."""

import asyncio
import contextlib
import json
from collections import defaultdict
from collections.abc import AsyncGenerator, Mapping
from contextlib import asynccontextmanager
from typing import Any
from uuid import UUID

import psycopg
import structlog
from sqlalchemy import text
from sqlalchemy.orm import Session

from ..storage.models import JobStatus

CHANNEL = "gaitlab_jobs"
RECONNECT = 0.5
"""Pause before another try when the database is away [s]."""
LONGEST_QUEUE = 200
log = structlog.stdlib.get_logger()


def announce(session: Session, job_id: UUID, status: JobStatus, progress: Mapping[str, Any] | None = None) -> None:
    """Tell everybody who listens, when the transaction is committed."""
    news = {"id": str(job_id), "status": status.value} | ({"progress": dict(progress)} if progress else {})
    session.execute(text("SELECT pg_notify(:channel, :news)"), {"channel": CHANNEL, "news": json.dumps(news)})


class EventBroker:
    """One connection that listens, and any number of browsers that get the news of their job."""

    def __init__(self, url: str) -> None:
        self._url = url
        self._queues: defaultdict[str, set[asyncio.Queue[dict[str, Any]]]] = defaultdict(set)
        self._task: asyncio.Task[None] | None = None
        self._listening = asyncio.Event()

    async def start(self) -> None:
        """Begin to listen, in the running event loop."""
        self._task = asyncio.create_task(self._listen())

    async def stop(self) -> None:
        """End listening."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
            self._task = None

    @asynccontextmanager
    async def subscribe(self, job_id: UUID) -> AsyncGenerator["asyncio.Queue[dict[str, Any]]"]:
        """Queue of the job's news: `status`, and `progress` where there is some.

        Read the job's row after this begins: then nothing is missed. After an outage of the database the news
        `{"lost": True}` asks to read the row again.
        """
        await self._listening.wait()
        queue: asyncio.Queue[dict[str, Any]] = asyncio.Queue(LONGEST_QUEUE)
        self._queues[str(job_id)].add(queue)
        try:
            yield queue
        finally:
            self._queues[str(job_id)].discard(queue)
            if not self._queues[str(job_id)]:
                del self._queues[str(job_id)]

    async def _listen(self) -> None:
        while True:
            try:
                async with await psycopg.AsyncConnection.connect(self._url, autocommit=True) as connection:
                    await connection.execute(f"LISTEN {CHANNEL}")
                    self._tell_all({"lost": True})
                    self._listening.set()
                    async for notification in connection.notifies():
                        self._pass_on(json.loads(notification.payload))
            except psycopg.OperationalError as error:
                log.warning("no news of jobs: the database is away", reason=type(error).__name__)
                await asyncio.sleep(RECONNECT)

    def _pass_on(self, news: dict[str, Any]) -> None:
        for queue in self._queues.get(news.get("id", ""), ()):
            _put(queue, news)

    def _tell_all(self, news: dict[str, Any]) -> None:
        for queues in self._queues.values():
            for queue in queues:
                _put(queue, news)


def _put(queue: "asyncio.Queue[dict[str, Any]]", news: dict[str, Any]) -> None:
    if queue.full():
        # A reader this slow gets the latest news only.
        queue.get_nowait()
    queue.put_nowait(news)
