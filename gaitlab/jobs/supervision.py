"""Starts the process of a computation, follows it, and ends it with everything it started."""

import asyncio
import contextlib
import json
import os
import signal
import sys
import time
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from .computing_process import OUTCOME
from .request import Work

PROCESS = "gaitlab.jobs.computing_process"
STDERR_KEPT = 4000
"""End of the process's messages that is kept with the job [characters]."""
INTERVAL = 0.5
"""Time between two looks at whether to go on [s]."""


class Verdict(StrEnum):
    """Whether to go on, or why not."""

    GO_ON = "go on"
    CANCEL = "cancel"
    SUPERSEDED = "superseded"
    """Another attempt has taken over, or the job is gone."""
    SHUTDOWN = "shutdown"
    TIME_OUT = "time-out"


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What a computation may cost."""

    seconds: float
    memory: int
    """Address space of the process [bytes]."""
    niceness: int = 0
    """How far it steps back behind other processes, 0 to 19."""


@dataclass(frozen=True, kw_only=True)
class Ended:
    """How a process ended."""

    verdict: Verdict
    """GO_ON: by itself; otherwise why it was ended."""
    code: int
    """Exit code; negative: the signal that ended it."""
    seconds: float
    outcome: Mapping[str, Any] | None
    """As `computations.outcome.Outcome`, or with `error` and `error_kind`; None: it did not come so far."""
    stderr: str

    @property
    def signal(self) -> str:
        """Name of the signal that ended it, or nothing."""
        return signal.Signals(-self.code).name if self.code < 0 else ""


@dataclass(frozen=True, kw_only=True)
class Watch:
    """Who follows a process."""

    progress: Callable[[Mapping[str, Any]], None]
    ask: Callable[[], Awaitable[Verdict]]
    """Asked every `INTERVAL`."""


async def run_process(work: Work, limits: Limits, watch: Watch, module: str = PROCESS) -> Ended:
    """Compute in a process group of its own until it ends or must not go on.

    To be called from the main thread's event loop: the process dies with the thread that starts it.
    """
    start = time.monotonic()
    reading, writing = os.pipe()
    with (work.folder / "stderr").open("w+b") as said:
        try:
            process = await asyncio.create_subprocess_exec(
                sys.executable, "-P", "-m", module, str(writing), stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.DEVNULL, stderr=said, pass_fds=(writing,), start_new_session=True,
                env=dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1"), cwd=work.folder,
            )  # fmt: skip
        finally:
            os.close(writing)
        reports = asyncio.create_task(_read(reading, watch.progress))
        try:
            await _tell(process, work, limits)
            verdict = await _follow(process, watch, start + limits.seconds)
        finally:
            _kill_group(process.pid)
            code = await process.wait()
            await reports
        return Ended(
            verdict=verdict,
            code=code,
            seconds=time.monotonic() - start,
            outcome=_outcome(work.folder / OUTCOME),
            stderr=_end_of(said),
        )


async def _tell(process: asyncio.subprocess.Process, work: Work, limits: Limits) -> None:
    described = {
        "kind": work.kind,
        "settings": dict(work.settings),
        "inputs": [dict(each) for each in work.inputs],
        "folder": str(work.folder),
        "memory": limits.memory,
        "niceness": limits.niceness,
        "parent": os.getpid(),
    }
    if process.stdin is not None:
        # A process that died at once is seen by `_follow`.
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            process.stdin.write(json.dumps(described).encode())
            await process.stdin.drain()
        process.stdin.close()


async def _follow(process: asyncio.subprocess.Process, watch: Watch, deadline: float) -> Verdict:
    end = asyncio.create_task(process.wait())
    while True:
        done, _ = await asyncio.wait({end}, timeout=INTERVAL)
        if done:
            return Verdict.GO_ON
        if time.monotonic() > deadline:
            return Verdict.TIME_OUT
        verdict = await watch.ask()
        if verdict is not Verdict.GO_ON:
            return verdict


async def _read(descriptor: int, progress: Callable[[Mapping[str, Any]], None]) -> None:
    """Pass on every complete line until the process has ended."""
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader()
    with os.fdopen(descriptor, "rb") as pipe:
        transport, _ = await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), pipe)
        with contextlib.closing(transport):
            while line := await reader.readline():
                with contextlib.suppress(json.JSONDecodeError):
                    progress(json.loads(line))


def _kill_group(group: int) -> None:
    """End the process and whatever it started; its own children outlive a normal end, too."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(group, signal.SIGKILL)


def _outcome(path: Path) -> Mapping[str, Any] | None:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError):
        return None


def _end_of(file: Any) -> str:
    file.seek(max(0, file.seek(0, os.SEEK_END) - STDERR_KEPT))
    return file.read().decode("utf-8", "replace").replace("\x00", "").strip()
