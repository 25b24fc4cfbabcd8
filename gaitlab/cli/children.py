"""Our own processes: started, watched, started again when they die, ended together."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from typing import Any

import structlog

QUICK_DEATH = 5.0
"""A process that lived shorter waits before it is started again [s]."""
FIRST_PAUSE, LONGEST_PAUSE = 0.2, 30.0
GRACE = 20.0
"""Time for an orderly end [s]."""
log = structlog.stdlib.get_logger()


class Child:
    """A Python module as a process. It gets its settings through stdin, and ends when that is closed.

    It may be started before there are settings: it then loads its modules meanwhile.
    """

    def __init__(self, module: str, descriptors: Sequence[int] = ()) -> None:
        self._module, self._descriptors = module, tuple(descriptors)
        self._settings: Mapping[str, Any] | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._started = self._not_before = 0.0
        self._quick_deaths = 0

    @property
    def pid(self) -> int | None:
        """Number of the process, if there is one."""
        return None if self._process is None else self._process.pid

    def ensure_running(self) -> None:
        """Start the process if it is not there, unless it has just died too often."""
        if self._process is not None and self._process.poll() is not None:
            self._bury(self._process)
        if self._process is None and time.monotonic() >= self._not_before:
            self._start()

    def _bury(self, process: "subprocess.Popen[bytes]") -> None:
        lived = time.monotonic() - self._started
        self._quick_deaths = self._quick_deaths + 1 if lived < QUICK_DEATH else 0
        pause = min(LONGEST_PAUSE, FIRST_PAUSE * 2**self._quick_deaths)
        log.warning("process died", module=self._module, code=process.returncode, pause=pause)
        self._not_before = time.monotonic() + pause
        _close(process)
        self._process = None

    def _start(self) -> None:
        command = [sys.executable, "-P", "-m", self._module, *map(str, self._descriptors)]
        self._started = time.monotonic()
        # A group of its own: Ctrl+C in the terminal reaches the parent only, which ends its children in order.
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, pass_fds=self._descriptors, start_new_session=True
        )
        self._say_settings()

    def tell(self, settings: Mapping[str, Any]) -> None:
        """Hand over the settings, to the running process and to those that follow it."""
        self._settings = settings
        self._say_settings()

    def _say_settings(self) -> None:
        if self._settings is not None and self._process is not None and self._process.stdin is not None:
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.write(json.dumps(self._settings).encode() + b"\n")
                self._process.stdin.flush()

    def terminate(self) -> None:
        """Ask the process to end."""
        if self._process is not None and self._process.poll() is None:
            self._process.terminate()

    def wait(self, seconds: float) -> None:
        """Wait for the end, and enforce it."""
        if self._process is not None:
            try:
                self._process.wait(seconds)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
            _close(self._process)
            self._process = None


def end_all(children: Sequence[Child]) -> None:
    """End processes together, in order and within `GRACE`."""
    deadline = time.monotonic() + GRACE
    for child in children:
        child.terminate()
    for child in children:
        child.wait(max(0.1, deadline - time.monotonic()))


def settings_from_parent() -> dict[str, Any]:
    """What the parent said, in a child; from now on the child ends when its parent does."""
    line = sys.stdin.buffer.readline()
    if not line:
        # The parent failed before it had settings, and has said why.
        sys.exit(1)
    said: dict[str, Any] = json.loads(line)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    return said


def _end_with_parent() -> None:
    # Not through sys.stdin: this thread would hold its lock when the process ends, which Python answers with an abort.
    while os.read(0, 1024):
        continue
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(GRACE)
    os._exit(1)


def _close(process: "subprocess.Popen[bytes]") -> None:
    if process.stdin is not None:
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()
