"""3D sessions: one process each, reached through us by its owner only, ended when idle or when its owner signs out."""

import asyncio
import contextlib
import json
import secrets
import shutil
import sys
import tempfile
import time
from collections.abc import AsyncGenerator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from uuid import UUID

import structlog
from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool

from ..errors import InvalidRequest, TooManyAttempts, WorkerLost

PROCESS = "gaitlab.viewer.child"
START_SECONDS = 60.0
STOP_SECONDS = 2.0
LOOK_EVERY = 1.0
"""Time between two looks at who is idle and who has signed out [s]."""
NEWS_KEPT = 4
"""States kept for a slow listener; older ones are of no use."""
log = structlog.stdlib.get_logger()


@dataclass(frozen=True, kw_only=True)
class Owner:
    """Who may look: the browser, or the token, that opened the 3D session."""

    user_id: UUID
    web_session_id: UUID | None
    token_id: UUID | None


@dataclass(kw_only=True, eq=False)
class Viewer:
    """A running 3D session."""

    id: str
    owner: Owner
    result_id: UUID
    folder: Path
    """Copies of the result's files, and the socket."""
    process: asyncio.subprocess.Process
    trials: tuple[str, ...] = ()
    last_seen: float = field(default_factory=time.monotonic)
    connections: int = 0
    ended: asyncio.Event = field(default_factory=asyncio.Event)
    listeners: set["asyncio.Queue[str]"] = field(default_factory=set["asyncio.Queue[str]"])
    state: str = ""
    """What its process told last, JSON."""

    @property
    def socket(self) -> Path:
        """Where viser listens."""
        return self.folder / "viser"

    async def command(self, line: str) -> None:
        """Pass one line of JSON to the process."""
        if self.process.stdin is not None and not self.ended.is_set():
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                self.process.stdin.write(line.replace("\n", " ").encode() + b"\n")
                await self.process.stdin.drain()

    @asynccontextmanager
    async def attached(self) -> AsyncGenerator[None]:
        """Somebody looks: the session is not idle."""
        self.connections += 1
        try:
            yield
        finally:
            self.connections -= 1
            self.last_seen = time.monotonic()


@dataclass(frozen=True, kw_only=True)
class Limits:
    """How many 3D sessions there may be, and how long they may be left alone."""

    per_user: int
    together: int
    idle: float
    """[s]"""


class Viewers:
    """All 3D sessions of this process."""

    def __init__(self, limits: Limits, signed_out: Callable[[Sequence[Owner]], set[Owner]]) -> None:
        self._limits, self._signed_out = limits, signed_out
        self._running: dict[str, Viewer] = {}
        self._opening: dict[UUID, int] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._loop: asyncio.AbstractEventLoop | None = None

    def __len__(self) -> int:
        return len(self._running)

    def start(self) -> None:
        """Begin to look after the sessions, in the running event loop."""
        self._loop = asyncio.get_running_loop()
        self._spawn(self._look_after())

    async def stop(self) -> None:
        """End all sessions."""
        for task in [*self._tasks]:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await asyncio.gather(*(self.close(viewer) for viewer in [*self._running.values()]))

    async def open(self, owner: Owner, result_id: UUID, fill: Callable[[Path], None]) -> Viewer:
        """Start a session on the files that `fill` writes into a folder.

        Raises:
            TooManyAttempts: The user, or all users together, have as many as are allowed.
            InvalidRequest: The result holds nothing that can be shown.
            WorkerLost: The process did not start.
        """
        self._check_limits(owner)
        self._opening[owner.user_id] = self._opening.get(owner.user_id, 0) + 1
        folder = Path(tempfile.mkdtemp(prefix="gaitlab-viewer-"))
        try:
            await run_in_threadpool(fill, folder / "result")
            viewer = await self._start(owner, result_id, folder)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        finally:
            self._opening[owner.user_id] -= 1
        self._running[viewer.id] = viewer
        self._spawn(self._hear(viewer))
        return viewer

    def get(self, viewer_id: str, owner: Owner) -> Viewer | None:
        """A running session of this owner's."""
        found = self._running.get(viewer_id)
        return found if found is not None and found.owner == owner else None

    def count_of(self, user_id: UUID) -> int:
        """Number of sessions of a user."""
        return sum(1 for each in self._running.values() if each.owner.user_id == user_id)

    def close_session(self, web_session_id: UUID) -> None:
        """End the sessions of a browser that signs out; may be called from any thread."""
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._close_of, web_session_id)

    async def close(self, viewer: Viewer) -> None:
        """End a session: everybody who looks is cut off at once, then the process ends."""
        if self._running.pop(viewer.id, None) is None:
            return
        viewer.ended.set()
        await _end(viewer.process)
        await run_in_threadpool(shutil.rmtree, viewer.folder, True)

    def _check_limits(self, owner: Owner) -> None:
        mine = self.count_of(owner.user_id)
        mine += self._opening.get(owner.user_id, 0)
        if mine >= self._limits.per_user:
            raise TooManyAttempts(f"you have {mine} 3D sessions open, as many as are allowed: close one", 1.0)
        together = len(self._running) + sum(self._opening.values())
        if together >= self._limits.together:
            raise TooManyAttempts(f"{together} 3D sessions are open, as many as are allowed: try again later", 30.0)

    async def _start(self, owner: Owner, result_id: UUID, folder: Path) -> Viewer:
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-P", "-m", PROCESS, str(folder / "result"), str(folder / "viser"),
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.DEVNULL,
        )  # fmt: skip
        try:
            told = await asyncio.wait_for(_first_line(process), START_SECONDS)
        except BaseException:
            await _end(process)
            raise
        return Viewer(
            id=secrets.token_urlsafe(16),
            owner=owner,
            result_id=result_id,
            folder=folder,
            process=process,
            trials=tuple(told["trials"]),
        )

    async def _hear(self, viewer: Viewer) -> None:
        """Pass the process's reports on until it ends; then the session ends, too."""
        if viewer.process.stdout is None:
            return
        while line := await viewer.process.stdout.readline():
            viewer.state = line.decode().strip()
            for queue in viewer.listeners:
                if queue.full():
                    queue.get_nowait()
                queue.put_nowait(viewer.state)
        await self.close(viewer)

    async def _look_after(self) -> None:
        while True:
            await asyncio.sleep(LOOK_EVERY)
            left = time.monotonic() - self._limits.idle
            idle = [each for each in self._running.values() if not each.connections and each.last_seen < left]
            for viewer in idle:
                await self.close(viewer)
            owners = [*{viewer.owner for viewer in self._running.values()}]
            if owners:
                try:
                    gone = await run_in_threadpool(self._signed_out, owners)
                except SQLAlchemyError as error:
                    log.warning("sessions could not be checked", reason=type(error).__name__)
                    continue
                self._close_all([viewer for viewer in self._running.values() if viewer.owner in gone])

    def _close_of(self, web_session_id: UUID) -> None:
        self._close_all([viewer for viewer in self._running.values() if viewer.owner.web_session_id == web_session_id])

    def _close_all(self, viewers: Sequence[Viewer]) -> None:
        for viewer in viewers:
            viewer.ended.set()
            self._spawn(self.close(viewer))

    def _spawn(self, work: Any) -> None:
        task: asyncio.Task[None] = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)


async def _first_line(process: asyncio.subprocess.Process) -> Mapping[str, Any]:
    line = b"" if process.stdout is None else await process.stdout.readline()
    try:
        told = json.loads(line)
    except json.JSONDecodeError as error:
        raise WorkerLost("the 3D session ended before it began: try again") from error
    if "error" in told:
        raise InvalidRequest(told["error"])
    return told


async def _end(process: asyncio.subprocess.Process) -> None:
    """Close its stdin, which ends it; kill it if that takes too long."""
    if process.stdin is not None:
        process.stdin.close()
    try:
        await asyncio.wait_for(process.wait(), STOP_SECONDS)
    except TimeoutError:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()
